"""Network of SBP-YOLO: blocks, heads, models of the paper's ladder, and their checkpoints."""
