"""ONNX export: graph optimisation, quantisation, verification and benchmark."""
