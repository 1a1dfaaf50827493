"""Tables of the paper (arXiv 2508.01339), one command each."""
