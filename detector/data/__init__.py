"""Labelled images: reading, conversion, and augmentation."""
