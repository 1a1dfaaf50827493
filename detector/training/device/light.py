"""Photometric augmentation of a batch on a device: colour, contrast, shadows, haze, blur, noise, style.

All functions take images (B, 3, H, W) in 0..1 and draw for each image on its own.
"""

import math

import torch
from torch import Tensor
from torch.fft import irfft2, rfft2
from torch.nn.functional import conv2d, interpolate

from foreride.detector.training.device.random_numbers import Random

SHADOWED, HAZY, BLURRED, NOISY, GREY = 0.24, 0.06, 0.15, 0.3, 0.1
"""Shares of the images with a shadow, haze, blur and noise, and without colour."""
_BLUR_PX = 4  # half the side of a blur kernel


def augmented(images: Tensor, rng: Random) -> Tensor:
    """Images under other light and through other cameras, as uint8 in channels-last order."""
    changed = _noise(_blur(_haze(_shadow(_colour(images, rng), rng), rng), rng), rng)
    return (
        (changed.clamp(0.0, 1.0) * 255.0)
        .round()
        .to(torch.uint8)
        .contiguous(memory_format=torch.channels_last)
    )


def restyled(images: Tensor, styles: Tensor, reach: float) -> Tensor:
    """Images with the amplitudes of the lowest frequencies of `styles`, of the same shape.

    Yang and Soatto, FDA: Fourier Domain Adaptation, CVPR 2020, eq. 3; `reach` is their beta.
    """
    source, style = rfft2(images), rfft2(styles)
    amplitude, low = source.abs(), max(1, int(reach * min(images.shape[2:])))
    for rows in (slice(None, low + 1), slice(-low, None)):
        amplitude[:, :, rows, : low + 1] = style[:, :, rows, : low + 1].abs()
    return irfft2(torch.polar(amplitude, source.angle()), s=images.shape[2:]).clamp(0.0, 1.0)


def _each(values: Tensor) -> Tensor:
    """Values (B,) or (B, 3), to be broadcast over images."""
    return values.view(len(values), -1, 1, 1)


def _colour(images: Tensor, rng: Random) -> Tensor:
    """Gamma, colour cast, saturation, hue, contrast and brightness."""
    count = len(images)
    changed = images.clamp(1e-4, 1.0) ** _each(rng.log_normal(0.25, count))
    changed = changed * _each(rng.log_normal(0.05, count, 3))
    grey = changed.mean(1, keepdim=True)
    saturation = rng.log_normal(0.45, count).masked_fill(rng.chosen(count, GREY), 0.0)
    changed = torch.einsum(
        "bij,bjhw->bihw", _hue(0.12 * rng.normal(count)), grey + (changed - grey) * _each(saturation)
    )
    contrast, brightness = rng.log_normal(0.25, count), 0.07 * rng.normal(count)
    return (changed - 0.5) * _each(contrast) + 0.5 + _each(brightness)


def _hue(angle: Tensor) -> Tensor:
    """(B, 3, 3) rotations of the colours about the grey axis."""
    cosine, sine = angle.cos(), angle.sin() / math.sqrt(3.0)
    share = (1.0 - cosine) / 3.0
    same, next_, last = cosine + share, share - sine, share + sine
    return torch.stack((same, next_, last, last, same, next_, next_, last, same), 1).view(-1, 3, 3)


def _shadow(images: Tensor, rng: Random) -> Tensor:
    """Soft strips, as of poles and houses, or blotches, as of trees."""
    count, _, height, width = images.shape
    kind, depth = rng.uniform(count), 0.25 + 0.45 * rng.uniform(count)
    masks = torch.zeros(count, 1, height, width, device=images.device)
    masks = torch.where(_each(kind < SHADOWED / 2), _strips(count, height, width, rng), masks)
    blotched = (kind >= SHADOWED / 2) & (kind < SHADOWED)
    masks = torch.where(_each(blotched), _blotches(count, height, width, rng), masks)
    return images * (1.0 - masks * _each(depth))


def _strips(count: int, height: int, width: int, rng: Random) -> Tensor:
    y = torch.linspace(0.0, 1.0, height, device=rng.device).view(1, 1, -1, 1)
    x = torch.linspace(0.0, 1.0, width, device=rng.device).view(1, 1, 1, -1)
    angle, middle = 2 * math.pi * rng.uniform(count), 1.2 * rng.uniform(count) - 0.2
    half, softness = 0.04 + 0.25 * rng.uniform(count), (-2.5 - 2.5 * rng.uniform(count)).exp()
    across = x * _each(angle.cos()) + y * _each(angle.sin()) - _each(middle)
    return ((_each(half) - (across - _each(half)).abs()) / _each(softness)).sigmoid()


def _blotches(count: int, height: int, width: int, rng: Random) -> Tensor:
    size = (height, width)
    coarse = interpolate(rng.normal(count, 1, 9, 14), size, mode="bicubic", align_corners=False)
    fine = interpolate(rng.normal(count, 1, 30, 46), size, mode="bilinear", align_corners=False)
    return (6.0 * (coarse + 0.6 * fine) - 2.0).sigmoid()


def _haze(images: Tensor, rng: Random) -> Tensor:
    """Haze, denser towards the top of the image."""
    count, _, height, _ = images.shape
    density = (0.1 + 0.5 * rng.uniform(count)).masked_fill(~rng.chosen(count, HAZY), 0.0)
    depth = torch.linspace(1.0, 0.1, height, device=images.device).view(1, 1, -1, 1)
    share, colour = _each(density) * depth, _each(0.5 + 0.45 * rng.uniform(count))
    return images * (1.0 - share) + colour * share


def _blur(images: Tensor, rng: Random) -> Tensor:
    """Defocus or motion blur of some images, all that there are of a small batch by the same chance."""
    count, _, height, width = images.shape
    blurred = rng.chosen(count, BLURRED).nonzero().squeeze(1)
    if not len(blurred):
        return images
    kernels = _kernels(len(blurred), rng)[:, None].repeat_interleave(3, 0)
    planes = images[blurred].reshape(1, -1, height, width)
    changed = conv2d(planes, kernels, padding=_BLUR_PX, groups=planes.shape[1])
    return images.index_copy(0, blurred, changed.view(-1, 3, height, width))


def _kernels(count: int, rng: Random) -> Tensor:
    """(B, side, side) Gaussian or line kernels of sum 1."""
    at = torch.arange(-_BLUR_PX, _BLUR_PX + 1.0, device=rng.device)
    x, y = at.view(1, 1, -1), at.view(1, -1, 1)
    sigma, length, angle = (
        values.view(-1, 1, 1)
        for values in (
            0.3 + 1.3 * rng.uniform(count),
            1.0 + 3.0 * rng.uniform(count),
            math.pi * rng.uniform(count),
        )
    )
    gaussian = (-(x**2 + y**2) / (2.0 * sigma**2)).exp()
    along, across = x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin()
    line = (-2.0 * across**2).exp() * (along.abs() <= length)
    kernels = torch.where(rng.chosen(count, 0.5).view(-1, 1, 1), gaussian, line)
    return kernels / kernels.sum((1, 2), keepdim=True)


def _noise(images: Tensor, rng: Random) -> Tensor:
    """Sensor noise of some images, of one colour or of three."""
    count, _, height, width = images.shape
    amplitude = (0.035 * rng.uniform(count)).masked_fill(~rng.chosen(count, NOISY), 0.0)
    grey, coloured = rng.normal(count, 1, height, width), rng.normal(count, 3, height, width)
    return images + _each(amplitude) * torch.where(_each(rng.chosen(count, 0.5)), grey, coloured)
