"""Tables of results over the reporting set, each by one command."""
