"""What a follower is to do: laws, segments, and the programme that joins them."""
