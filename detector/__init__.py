"""SBP-YOLO: an RGB image in, boxes of speed bumps and potholes out.

`runtime.Detector` needs onnxruntime, numpy and OpenCV only; torch is imported by the model, loss,
training and export files alone.
"""
