from collections.abc import Callable
from os import PathLike
from typing import Any

from numpy import float64
from numpy.typing import ArrayLike, NDArray

__version__: str

class ModelError(ValueError): ...
class SimulationError(RuntimeError): ...

class Function:
    @property
    def is_compiled(self) -> bool: ...
    def __call__(self, *args: Any) -> Any: ...

class Core:
    @staticmethod
    def from_text(text: str, name: str, freeze: list[str], backend: str) -> Core: ...
    @staticmethod
    def from_file(path: str | PathLike[str], freeze: list[str], backend: str) -> Core: ...
    @staticmethod
    def from_calls(
        calls: list[tuple[str, list[int], list[float], list[str], tuple[str, int, int]]],
        freeze: list[str],
        backend: str,
    ) -> Core: ...
    def function(self, number: int) -> Function: ...
    @property
    def parameters(self) -> NDArray[float64]: ...
    def set_parameters(self, values: ArrayLike) -> None: ...
    def copy(self) -> Core: ...
    @property
    def info(self) -> dict[str, Any]: ...

def simulate(
    core: Core,
    q: ArrayLike,
    qd: ArrayLike,
    t: tuple[float, float],
    times: ArrayLike | None,
    method: tuple[str, float, float, float, float, int],
    u: ArrayLike | Callable[..., ArrayLike] | None,
    prescribed: ArrayLike | Callable[[float], ArrayLike] | None,
    events: list[tuple[Callable[..., float], int, bool, Callable[..., Any] | None]],
    project: bool,
) -> dict[str, Any]: ...
def set_threads(count: int) -> None: ...
def threads() -> int: ...
