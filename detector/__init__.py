"""SBP-YOLO object detector: boxes of speed bumps and potholes in an RGB image.

`runtime.Detector` needs onnxruntime, numpy and OpenCV only; torch is imported by the model, loss,
training and export files alone.
"""
