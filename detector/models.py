"""SBP-YOLO: YOLOv11's layout with Ghost and GS blocks and a fourth, stride-4 level (Fig. 2)."""

from torch import Tensor, cat, nn
from torch.nn.functional import interpolate

from detector.blocks import C2PSA, SPPF, C3k2, Conv, GhostConv, VoVGSCSPC
from detector.heads import LEDH, Predictions

STRIDES = (4, 8, 16, 32)


class SbpYolo(nn.Module):
    """(B, 3, H, W) in 0..1, H and W multiples of 32, to the head's `Predictions`.

    `width` scales every channel count: 0.25 is the paper's model (n), 0.5 its teacher (s).
    """

    def __init__(self, width: float = 0.25, classes: int = 2):
        super().__init__()

        def c(channels: int) -> int:
            return int(channels * width)

        self.stem = Conv(3, c(64), 3, 2)
        self.stage2 = nn.Sequential(Conv(c(64), c(128), 3, 2), C3k2(c(128), c(256), 0.25))
        self.stage3 = nn.Sequential(Conv(c(256), c(256), 3, 2), C3k2(c(256), c(512), 0.25))
        self.stage4 = nn.Sequential(GhostConv(c(512), c(512), 3, 2), VoVGSCSPC(c(512), c(512)))
        self.stage5 = nn.Sequential(
            GhostConv(c(512), c(1024), 3, 2), VoVGSCSPC(c(1024), c(1024)), SPPF(c(1024)), C2PSA(c(1024))
        )
        self.top4 = C3k2(c(1024) + c(512), c(512))
        self.top3 = C3k2(c(512) + c(512), c(256))
        self.top2 = C3k2(c(256) + c(256), c(128))
        self.down3 = Conv(c(128), c(256), 3, 2)
        self.out3 = C3k2(c(256) + c(256), c(256))
        self.down4 = Conv(c(256), c(256), 3, 2)
        self.out4 = VoVGSCSPC(c(256) + c(512), c(512))
        self.down5 = GhostConv(c(512), c(512), 3, 2)
        self.out5 = VoVGSCSPC(c(512) + c(1024), c(1024))
        self.head = LEDH((c(128), c(256), c(512), c(1024)), STRIDES, classes)

    def pyramid(self, image: Tensor) -> list[Tensor]:
        """The four maps that the head reads, strides 4 to 32."""
        p2 = self.stage2(self.stem(image))
        p3 = self.stage3(p2)
        p4 = self.stage4(p3)
        p5 = self.stage5(p4)
        t4 = self.top4(cat((_double(p5), p4), 1))
        t3 = self.top3(cat((_double(t4), p3), 1))
        o2 = self.top2(cat((_double(t3), p2), 1))
        o3 = self.out3(cat((self.down3(o2), t3), 1))
        o4 = self.out4(cat((self.down4(o3), t4), 1))
        o5 = self.out5(cat((self.down5(o4), p5), 1))
        return [o2, o3, o4, o5]

    def forward(self, image: Tensor) -> Predictions:
        return self.head(self.pyramid(image))


def _double(x: Tensor) -> Tensor:
    return interpolate(x, scale_factor=2.0, mode="nearest")


def count_parameters(model: nn.Module) -> int:
    """Learned numbers."""
    return sum(p.numel() for p in model.parameters())
