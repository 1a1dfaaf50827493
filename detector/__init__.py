"""From an image to boxes around speed bumps and potholes."""
