"""Training views made on the device that trains: images in its memory, cropped and lit as batches."""
