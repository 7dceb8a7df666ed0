"""From sizes, drive and branch to where every body is: in which order bodies are placed, and how each is."""
