"""Network architectures: YOLOv11n to SBP-YOLO, the ablation ladder of arXiv 2508.01339, Table 1."""

from dataclasses import dataclass

from torch import Tensor, cat, nn
from torch.nn.functional import interpolate

from foreride.detector.network.blocks import C2PSA, SPPF, C3k2, Conv, GhostConv, VoVGSCSPC
from foreride.detector.network.heads import LEDH, DecoupledHead, Predictions
from foreride.files.errors import InputError
from foreride.road.obstacle_classes import CLASS_NAMES


@dataclass(frozen=True)
class Layout:
    """Architecture options of a network; without any of the four parts it is YOLOv11.

    p2: a fourth level of stride 4. ledh: the light head. ghost: GhostConv in stages 4 and 5 and before the
    last level. vovgscspc: VoVGSCSPC blocks at strides 16 and 32. width: scale of all channel counts, 0.25
    for n and 0.5 for s.
    """

    p2: bool = False
    ledh: bool = False
    ghost: bool = False
    vovgscspc: bool = False
    width: float = 0.25


SBP_YOLO = Layout(p2=True, ledh=True, ghost=True, vovgscspc=True)
MODELS = {
    "yolo11n": Layout(),
    "+p2": Layout(p2=True),
    "+ledh": Layout(p2=True, ledh=True),
    "+ghost": Layout(p2=True, ledh=True, ghost=True),
    "+vovgscspc": SBP_YOLO,
    "sbp-yolo": SBP_YOLO,
    "sbp-yolo-s": Layout(p2=True, ledh=True, ghost=True, vovgscspc=True, width=0.5),
}


class Network(nn.Module):
    """Detection network: (B, 3, H, W) in 0..1, H and W multiples of 32, to the head's `Predictions`."""

    def __init__(self, layout: Layout = SBP_YOLO, classes: int = len(CLASS_NAMES)):
        super().__init__()

        def c(channels: int) -> int:
            return int(channels * layout.width)

        def deep(c_in: int, c_out: int, nested: bool = True) -> nn.Module:
            return VoVGSCSPC(c_in, c_out) if layout.vovgscspc else C3k2(c_in, c_out, nested=nested)

        shrink = GhostConv if layout.ghost else Conv
        self.layout, self.strides = layout, (4, 8, 16, 32) if layout.p2 else (8, 16, 32)
        self.stem = Conv(3, c(64), 3, 2)
        self.stage2 = nn.Sequential(Conv(c(64), c(128), 3, 2), C3k2(c(128), c(256), 0.25))
        self.stage3 = nn.Sequential(Conv(c(256), c(256), 3, 2), C3k2(c(256), c(512), 0.25))
        self.stage4 = nn.Sequential(shrink(c(512), c(512), 3, 2), deep(c(512), c(512)))
        self.stage5 = nn.Sequential(
            shrink(c(512), c(1024), 3, 2), deep(c(1024), c(1024)), SPPF(c(1024)), C2PSA(c(1024))
        )
        self.top4 = C3k2(c(1024) + c(512), c(512))
        self.top3 = C3k2(c(512) + c(512), c(256))
        if layout.p2:
            self.top2 = C3k2(c(256) + c(256), c(128))
            self.down3 = Conv(c(128), c(256), 3, 2)
            self.out3 = C3k2(c(256) + c(256), c(256))
        self.down4 = Conv(c(256), c(256), 3, 2)
        self.out4 = deep(c(256) + c(512), c(512), nested=False)
        self.down5 = shrink(c(512), c(512), 3, 2)
        self.out5 = deep(c(512) + c(1024), c(1024))
        levels = (c(128), c(256), c(512), c(1024))[-len(self.strides) :]
        self.head = (LEDH if layout.ledh else DecoupledHead)(levels, self.strides, classes)

    def pyramid(self, image: Tensor) -> list[Tensor]:
        """Feature pyramid: inputs of the head, one map per stride."""
        p2 = self.stage2(self.stem(image))
        p3 = self.stage3(p2)
        p4 = self.stage4(p3)
        p5 = self.stage5(p4)
        t4 = self.top4(cat((_upsample2(p5), p4), 1))
        o3 = t3 = self.top3(cat((_upsample2(t4), p3), 1))
        finest = []
        if self.layout.p2:
            finest = [self.top2(cat((_upsample2(t3), p2), 1))]
            o3 = self.out3(cat((self.down3(finest[0]), t3), 1))
        o4 = self.out4(cat((self.down4(o3), t4), 1))
        o5 = self.out5(cat((self.down5(o4), p5), 1))
        return [*finest, o3, o4, o5]

    def forward(self, image: Tensor) -> Predictions:
        return self.head(self.pyramid(image))


def _upsample2(x: Tensor) -> Tensor:
    return interpolate(x, scale_factor=2.0, mode="nearest")


def build(name: str, classes: int = len(CLASS_NAMES)) -> Network:
    """Untrained network by its name in `MODELS`. Raises InputError listing the names."""
    if name not in MODELS:
        raise InputError(f"model must be one of {', '.join(MODELS)}, got {name!r}")
    return Network(MODELS[name], classes)
