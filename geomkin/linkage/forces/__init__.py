"""What a moving linkage does to its frame."""
