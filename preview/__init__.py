"""Road preview: height ahead of each wheel, with uncertainty, from detections and ego motion."""
