"""Network blocks of SBP-YOLO (arXiv 2508.01339, sections 2.2 and 2.3) and of its YOLOv11 base.

Every block maps (B, C_in, H, W) to (B, C_out, H / stride, W / stride).
"""

import torch
from torch import Tensor, nn


class Conv(nn.Module):
    """Convolution without bias, batch norm, and SiLU (optional)."""

    def __init__(
        self, c_in: int, c_out: int, kernel: int = 1, stride: int = 1, groups: int = 1, act: bool = True
    ):
        super().__init__()
        self.conv = nn.Conv2d(c_in, c_out, kernel, stride, kernel // 2, groups=groups, bias=False)
        self.norm = nn.BatchNorm2d(c_out, eps=1e-3, momentum=0.03)
        self.act = nn.SiLU() if act else nn.Identity()  # not in place: the backward pass would need a copy

    def forward(self, x: Tensor) -> Tensor:
        if self.training and self.conv.groups == self.conv.in_channels:
            # On a CPU the bf16 gradient of a depthwise convolution takes five times as long as the fp32 one.
            with torch.autocast(x.device.type, enabled=False):
                y = self.conv(x.float()).to(x.dtype)
        else:
            y = self.conv(x)
        return self.act(self.norm(y))


class Bottleneck(nn.Module):
    """Residual bottleneck: two 3×3 convolutions through a share of the channels, plus the input."""

    def __init__(self, channels: int, share: float = 0.5):
        super().__init__()
        hidden = int(channels * share)
        self.reduce = Conv(channels, hidden, 3)
        self.expand = Conv(hidden, channels, 3)

    def forward(self, x: Tensor) -> Tensor:
        return x + self.expand(self.reduce(x))


class C3k(nn.Module):
    """Cross-stage partial block (C3k) of two full-width bottlenecks, on half the channels each way."""

    def __init__(self, channels: int):
        super().__init__()
        hidden = channels // 2
        self.deep = nn.Sequential(Conv(channels, hidden), Bottleneck(hidden, 1.0), Bottleneck(hidden, 1.0))
        self.direct = Conv(channels, hidden)
        self.fuse = Conv(2 * hidden, channels)

    def forward(self, x: Tensor) -> Tensor:
        return self.fuse(torch.cat((self.deep(x), self.direct(x)), 1))


class C3k2(nn.Module):
    """YOLOv11's C3k2 block: half the channels pass a bottleneck (or, nested, a C3k); all parts are fused."""

    def __init__(self, c_in: int, c_out: int, expansion: float = 0.5, nested: bool = False):
        super().__init__()
        hidden = int(c_out * expansion)
        self.split = Conv(c_in, 2 * hidden)
        self.bottleneck = C3k(hidden) if nested else Bottleneck(hidden)
        self.fuse = Conv(3 * hidden, c_out)

    def forward(self, x: Tensor) -> Tensor:
        hidden = self.split.conv.out_channels // 2
        first, second = self.split(x).split((hidden, hidden), 1)
        return self.fuse(torch.cat((first, second, self.bottleneck(second)), 1))


class GhostConv(nn.Module):
    """Ghost convolution: k×k to half the channels, 5×5 depthwise for the other half (eq. 1-4)."""

    def __init__(self, c_in: int, c_out: int, kernel: int = 1, stride: int = 1):
        super().__init__()
        self.primary = Conv(c_in, c_out // 2, kernel, stride)
        self.cheap = Conv(c_out // 2, c_out // 2, 5, groups=c_out // 2)

    def forward(self, x: Tensor) -> Tensor:
        primary = self.primary(x)
        return torch.cat((primary, self.cheap(primary)), 1)


class GSConv(GhostConv):
    """GSConv: GhostConv followed by a channel shuffle, even channels before odd ones (eq. 5)."""

    def forward(self, x: Tensor) -> Tensor:
        ghost = super().forward(x)
        batch, channels, height, width = ghost.shape
        return ghost.view(batch, channels // 2, 2, height, width).transpose(1, 2).flatten(1, 2)


class GSBottleneck(nn.Module):
    """GS bottleneck: GSConv 1×1, GSConv 3×3, and a 1×1 depthwise shortcut (eq. 6)."""

    def __init__(self, channels: int):
        super().__init__()
        self.body = nn.Sequential(GSConv(channels, channels // 2, 1), GSConv(channels // 2, channels, 3))
        self.shortcut = Conv(channels, channels, groups=channels, act=False)

    def forward(self, x: Tensor) -> Tensor:
        return self.body(x) + self.shortcut(x)


class VoVGSCSPC(nn.Module):
    """Cross-stage partial block with one GS bottleneck (VoVGSCSPC, eq. 7)."""

    def __init__(self, c_in: int, c_out: int):
        super().__init__()
        hidden = c_out // 2
        self.deep = nn.Sequential(Conv(c_in, hidden), GSBottleneck(hidden))
        self.direct = Conv(c_in, hidden)
        self.fuse = Conv(2 * hidden, c_out)

    def forward(self, x: Tensor) -> Tensor:
        return self.fuse(torch.cat((self.deep(x), self.direct(x)), 1))


class SPPF(nn.Module):
    """Spatial pyramid pooling, fast (SPPF): three 5×5 max pools in series, all stages concatenated."""

    def __init__(self, channels: int):
        super().__init__()
        self.reduce = Conv(channels, channels // 2)
        self.pool = nn.MaxPool2d(5, 1, 2)
        self.fuse = Conv(2 * channels, channels)

    def forward(self, x: Tensor) -> Tensor:
        stages = [self.reduce(x)]
        for _ in range(3):
            stages.append(self.pool(stages[-1]))
        return self.fuse(torch.cat(stages, 1))


class Attention(nn.Module):
    """Multi-head self-attention over positions with a depthwise positional term.

    Heads of 64 channels; keys and queries take half as many.
    """

    def __init__(self, channels: int):
        super().__init__()
        self.heads = channels // 64
        self.qkv = Conv(channels, 2 * channels, act=False)
        self.position = Conv(channels, channels, 3, groups=channels, act=False)
        self.project = Conv(channels, channels, act=False)

    def forward(self, x: Tensor) -> Tensor:
        batch, channels, height, width = x.shape
        qkv = self.qkv(x).reshape(batch, self.heads, 128, height * width)
        query, key, value = qkv.split((32, 32, 64), 2)
        weight = (query.transpose(2, 3) @ key * 32**-0.5).softmax(-1)
        attended = (value @ weight.transpose(2, 3)).reshape(batch, channels, height, width)
        return self.project(attended + self.position(value.reshape(batch, channels, height, width)))


class C2PSA(nn.Module):
    """YOLOv11's C2PSA block: attention and a feed-forward pair on one half of the channels."""

    def __init__(self, channels: int):
        super().__init__()
        half = channels // 2
        self.split = Conv(channels, channels)
        self.attention = Attention(half)
        self.feed = nn.Sequential(Conv(half, 2 * half), Conv(2 * half, half, act=False))
        self.fuse = Conv(channels, channels)

    def forward(self, x: Tensor) -> Tensor:
        half = self.split.conv.out_channels // 2
        direct, deep = self.split(x).split((half, half), 1)
        deep = deep + self.attention(deep)
        deep = deep + self.feed(deep)
        return self.fuse(torch.cat((direct, deep), 1))
