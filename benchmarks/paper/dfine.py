"""D-FINE-N (Peng et al., arXiv 2410.13842), from scratch or pre-trained, by transformers (Apache-2.0).

Needs the extra rivals. Weights of its authors are a folder with config.json and model.safetensors, such as
ustc-community/dfine-nano-coco on Hugging Face (Apache-2.0). It sees the same batches as our models: same
images, views and order.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from foreride.detector.data.yolo_folder import read_samples
from foreride.detector.detections import CLASS_NAMES, Detections
from foreride.detector.network.checkpoint import Average, load, save
from foreride.detector.training.batches import Batch, batches
from foreride.detector.training.schedule import Stage, rate_factor
from foreride.files.errors import InputError, shown
from foreride.files.progress import Progress
from foreride.files.reading.strict_json import read_json

RATE, WEIGHT_DECAY, CLIP, WARM_UP = 4e-4, 1e-4, 0.1, 2000
"""From the authors' configuration for size N; the rate is half of theirs, as a batch is 16, not 128."""
LEAST_PIXELS = 61440
"""Minimum number of pixels: its 300 queries are selected from the points at strides 16 and 32."""
KEPT = ("model", "average", "optimiser", "passes")


def check(stage: Stage) -> None:
    """Raise InputError if the images are too small or transformers is not installed."""
    if stage.width * stage.height < LEAST_PIXELS:
        raise InputError(
            f"row d-fine-n: needs images of {LEAST_PIXELS} pixels or more, got {stage.width}x{stage.height}"
        )
    try:
        from transformers import DFineForObjectDetection  # noqa: F401
    except ImportError as error:
        raise InputError(
            f"row d-fine-n: needs the package transformers (pip install 'foreride[rivals]'): {error}"
        ) from None


def build(pretrained: Path | None = None) -> nn.Module:
    """Build the network with random weights, or with those of a folder and new classes. Raises InputError."""
    from transformers import DFineConfig, DFineForObjectDetection, HGNetV2Config

    if pretrained:
        return _pretrained(pretrained)
    backbone = HGNetV2Config(  # type: ignore[call-arg]
        stem_channels=[3, 16, 16],
        stage_in_channels=[16, 64, 256, 512],
        stage_mid_channels=[16, 32, 64, 128],
        stage_out_channels=[64, 256, 512, 1024],
        stage_num_blocks=[1, 1, 2, 1],
        stage_numb_of_layers=[3, 3, 3, 3],
        hidden_sizes=[64, 256, 512, 1024],
        use_learnable_affine_block=True,
        out_indices=[3, 4],
    )
    config = DFineConfig(
        backbone_config=backbone,
        freeze_backbone_batch_norms=False,
        id2label=dict(enumerate(CLASS_NAMES)),
        encoder_in_channels=[512, 1024],
        feat_strides=[16, 32],
        encoder_hidden_dim=128,
        encoder_ffn_dim=512,
        encode_proj_layers=[1],
        hidden_expansion=0.34,
        depth_mult=0.5,
        d_model=128,
        decoder_in_channels=[128, 128],
        decoder_ffn_dim=512,
        decoder_layers=3,
        decoder_n_points=[6, 6],
        num_feature_levels=2,
    )
    return DFineForObjectDetection(config)


def _pretrained(folder: Path) -> nn.Module:
    """The network of a folder as transformers saves it; its layers of classes begin anew."""
    from transformers import DFineConfig, DFineForObjectDetection

    config_file, names = folder / "config.json", dict(enumerate(CLASS_NAMES))
    try:
        kind = read_json(config_file)["model_type"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{config_file}: must be the configuration of a D-FINE network: {error}") from None
    if kind != DFineConfig.model_type:
        raise InputError(f"{config_file}: model_type must be {DFineConfig.model_type}, got {shown(kind)}")
    try:
        loaded: Any = DFineForObjectDetection.from_pretrained(
            folder,
            id2label=names,
            label2id={name: number for number, name in names.items()},
            ignore_mismatched_sizes=True,
            output_loading_info=True,
            local_files_only=True,
        )
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(f"{folder}: not weights that transformers can read: {error}") from None
    model, told = loaded
    if missing := sorted(told["missing_keys"]):
        raise InputError(f"{folder}: lacks {len(missing)} tensors of the network, first {missing[0]}")
    return model  # type: ignore[no-any-return]


def train(
    folder: Path, stage: Stage, out: Path, batch: int, seed: int, pretrained: Path | None = None
) -> tuple[nn.Module, int]:
    """Train to the end of the stage, from random or pre-trained weights, or on from `out`/checkpoint.pt.

    Returns the averaged model and the number of training images it has seen. Raises InputError.
    """
    check(stage)
    torch.manual_seed(seed)
    model = build(pretrained).train()
    samples = list(read_samples(folder, max(stage.width, stage.height, 640)))
    average = Average(model)
    optimiser = torch.optim.AdamW(model.parameters(), lr=RATE, weight_decay=WEIGHT_DECAY)
    parts: dict[str, Any] = {"model": model, "average": average.model, "optimiser": optimiser}
    passes, file = 0, out / "checkpoint.pt"
    if file.exists():
        content = load(file, KEPT)
        passes = content["passes"]
        for name, part in parts.items():
            part.load_state_dict(content[name])
    out.mkdir(parents=True, exist_ok=True)
    with Progress(stage.passes, passes) as progress:
        for number, made in enumerate(batches(samples, (stage,), batch, passes, seed, workers=1), 1):
            torch.manual_seed(seed + made.passes)  # denoising noise, reproducible after an interruption
            for group in optimiser.param_groups:
                group["lr"] = RATE * rate_factor((stage,), made.passes, WARM_UP)
            loss = model(pixel_values=made.images.float() / 255, labels=targets(made)).loss
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(model.parameters(), CLIP)
            optimiser.step()
            passes = made.passes + batch
            average.update(model, passes // batch)
            if number % 20 == 0:
                save(file, {name: part.state_dict() for name, part in parts.items()} | {"passes": passes})
            progress.show(passes, f"d-fine-n loss {loss.item():.2f}")
    save(file, {name: part.state_dict() for name, part in parts.items()} | {"passes": passes})
    return average.model.eval(), passes


def targets(batch: Batch) -> list[dict[str, Tensor]]:
    """Targets per image: classes, and boxes (centre, size) as fractions, of sufficiently large objects."""
    count, _, height, width = batch.images.shape
    asked = batch.truths.where(batch.truths.classes >= 0)
    scale = torch.tensor([width, height, width, height])
    low, high = (asked.boxes / scale).float().split(2, 1)
    boxes = torch.cat(((low + high) / 2, high - low), 1)
    mine = [asked.image == i for i in range(count)]
    return [{"class_labels": asked.classes[m].long(), "boxes": boxes[m]} for m in mine]


def detector(model: nn.Module) -> Callable[[NDArray[np.uint8]], Detections]:
    """Detection function; the network needs no non-maximum suppression."""

    def detect(image: NDArray[np.uint8]) -> Detections:
        height, width = image.shape[:2]
        with torch.inference_mode():
            found = model(pixel_values=torch.from_numpy(image).permute(2, 0, 1)[None].float() / 255)
        scores = found.logits[0].sigmoid()
        best = scores.flatten().topk(100).indices
        centre, size = found.pred_boxes[0].split(2, 1)
        boxes = torch.cat((centre - size / 2, centre + size / 2), 1) * torch.tensor([width, height] * 2)
        classes = len(CLASS_NAMES)
        return Detections(
            boxes[best // classes].numpy(), scores.flatten()[best].numpy(), (best % classes).numpy()
        )

    return detect
