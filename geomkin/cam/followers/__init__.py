"""What rides on a cam, one file each."""
