"""Motion programme of a follower: laws, segments, and the programme that joins them."""
