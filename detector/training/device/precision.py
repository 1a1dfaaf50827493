"""Precision of a training: bfloat16 where the device computes in it, else single precision."""

import torch

BF16_INSTRUCTIONS = ("avx512_bf16", "amx_bf16", "bf16")
"""Instruction sets for bfloat16 by their names in `torch.cpu.get_capabilities`: x86's two, and ARM's."""


def fastest_precision(device: str) -> str:
    """`bf16` or `fp32`, whichever the device (`cpu` or `cuda`) computes faster.

    A processor without instructions for bfloat16 emulates it, at a seventh of the speed of single precision.
    """
    if device == "cuda":
        return "bf16" if torch.cuda.is_bf16_supported(including_emulation=False) else "fp32"
    known = torch.cpu.get_capabilities()
    return "bf16" if any(known.get(name) for name in BF16_INSTRUCTIONS) else "fp32"
