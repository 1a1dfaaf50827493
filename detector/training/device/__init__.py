"""Device side of a training: its precision, and views of images in its memory, cropped and lit as batches."""
