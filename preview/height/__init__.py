"""Heights of tracked objects measured in images: stereo, and plane plus parallax."""
