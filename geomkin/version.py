"""The version, where the package's metadata and its files read it."""

VERSION = "0.1.0"
