"""Where pictures go: into an array, or into a window."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .errors import OptionError

Draw = Callable[[int, int], NDArray[np.uint8]]


class Screen:
    """A window if the mode is ``human``; otherwise nothing until a picture is asked for."""

    def __init__(self, mode: str | None, metadata: dict[str, Any], size: tuple[int, int]) -> None:
        if mode is not None and mode not in metadata["render_modes"]:
            raise OptionError(f"render_mode is one of {metadata['render_modes']}, got {mode!r}")
        self._mode = mode
        self._size = size
        self._frames_per_second = metadata["render_fps"]
        self._window: Any = None
        self._clock: Any = None

    def render(self, draw: Draw) -> NDArray[np.uint8] | None:
        """The picture in the mode ``rgb_array``."""
        if self._mode is None:
            gymnasium.logger.warn("render() needs a mode: make the environment with render_mode='rgb_array'")
            return None
        return draw(*self._size) if self._mode == "rgb_array" else None

    def show(self, draw: Draw) -> None:
        """Shows the picture in the window in the mode ``human``, no faster than real time."""
        if self._mode != "human":
            return
        try:
            import pygame
        except ImportError as error:
            raise gymnasium.error.DependencyNotInstalled(
                "a window needs pygame: pip install 'cohelm[human]'"
            ) from error
        if self._window is None:
            pygame.init()
            self._window = pygame.display.set_mode(self._size)
            pygame.display.set_caption("cohelm")
            self._clock = pygame.time.Clock()
        picture = pygame.surfarray.make_surface(draw(*self._size).swapaxes(0, 1))
        self._window.blit(picture, (0, 0))
        pygame.event.pump()
        pygame.display.flip()
        self._clock.tick(self._frames_per_second)

    def close(self) -> None:
        """Closes the window, if there is one."""
        if self._window is not None:
            import pygame

            pygame.display.quit()
            pygame.quit()
            self._window = None
