"""Jobs: a part with settings."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol

from . import _grainpath
from ._checks import name_of, nearest, toml, watch, whole, whole_text
from .errors import JobError
from .field import Field
from .image import Image
from .layers import LayerStack, table
from .mesh import Mesh
from .plan import Plan
from .report import Report
from .strength import Strength
from .stress import Stress
from .volume import Volume
from .warning import Warning, warnings_of

Shape = Mesh | Volume | LayerStack | Image | Sequence[Image]
Progress = Callable[[str, int, int], object]

#: The settings that name a shape in a job file; an array takes the place of all of them.
SHAPES: dict[str, Any] = {
    "shape.mesh": "",
    "shape.outline": "",
    "shape.ct.path": "",
    "shape.photo.files": [],
}


#: Settings that say what guides the fill, and how the file of a field is read: a guide that is an array says it itself.
FILES_OF_GUIDES = ("guide.field.path", "guide.import", "guide.image.files")
GUIDES = (
    "guide.kind",
    *FILES_OF_GUIDES,
    *(f"guide.field.{name}" for name in ("frame", "length_unit", "axes", "array", "cell_mm", "origin_mm")),
)
#: What may be said of a field that is an array: where its coordinates begin.
MAY_DIFFER = {"guide.field.frame", "guide.field.length_unit"}
#: Names that stand for a path where they are a text.
SHORT = {"shape.ct": "shape.ct.path", "guide.field": "guide.field.path"}


#: Settings that change a part, which a stack of sections does not take, and their values that change nothing.
AS_THEY_ARE: dict[str, Any] = {
    "shape.scale": 1.0,
    "shape.rotate_deg": [0.0, 0.0, 0.0],
    "process.adaptive_layers": False,
}


class Cancel(Protocol):
    """A token that ends a call, such as :class:`threading.Event`."""

    def is_set(self) -> bool:
        """Whether the call should end."""


class Job:
    """A part with settings. Jobs do not change; :meth:`with_` makes another.

    Settings are those of the job file (``docs/settings.md``), with two underscores for each dot: ``fill__density=0.4``.
    They are checked at once, and overrule the text of a job.

    >>> import grainpath as gp
    >>> job = gp.Job(gp.box(20, 10, 1), fill__density=0.4)
    >>> job["fill.density"], job.with_(fill__density=0.2)["fill.density"]
    (0.4, 0.2)
    """

    def __init__(
        self,
        shape: Shape | None = None,
        *,
        field: Field | None = None,
        stress: Stress | None = None,
        grain: Image | Sequence[Image] | None = None,
        text: str = "",
        name: str = "job",
        folder: str | os.PathLike[str] = "",
        **settings: Any,
    ) -> None:
        self._build(shape, field, stress, grain, text, name, name_of(folder, "folder"), _sets(settings))

    def _build(
        self,
        shape: Shape | None,
        field: Field | None,
        stress: Stress | None,
        grain: Image | Sequence[Image] | None,
        text: str,
        name: str,
        folder: str,
        sets: dict[str, Any],
    ) -> None:
        board = _images(shape)
        if shape is not None and board is None and not isinstance(shape, (Mesh, Volume, LayerStack)):
            raise JobError(
                f"shape is a {type(shape).__name__}; a Mesh, a Volume, a LayerStack or Images are needed; files are read "
                "by grainpath.read"
            )
        photos = _images(grain)
        if grain is not None and photos is None:
            raise JobError(f"grain is a {type(grain).__name__}; a grainpath.Image or a list of them is needed")
        if field is not None and not isinstance(field, Field):
            raise JobError(f"field is a {type(field).__name__}; a grainpath.Field is needed")
        if stress is not None and not isinstance(stress, Stress):
            raise JobError(f"stress is a {type(stress).__name__}; a grainpath.Stress is needed")
        if sum(guide is not None for guide in (field, stress, grain)) > 1:
            raise JobError("field, stress and grain: exactly one guides the fill")
        for word, given in (("text", text), ("name", name), ("folder", folder)):
            if not isinstance(given, str):
                raise JobError(f"{word} is a {type(given).__name__}; a str is needed")
            whole_text(given, word)
        self._hold(shape, field, stress, grain, text, name, folder, sets)
        # Read at once, so that what is wrong is told where it was written.
        _ = self._spec
        if isinstance(shape, LayerStack):
            self._check_layers()

    def _hold(
        self,
        shape: Shape | None,
        field: Field | None,
        stress: Stress | None,
        grain: Image | Sequence[Image] | None,
        text: str,
        name: str,
        folder: str,
        sets: dict[str, Any],
    ) -> None:
        """Keeps what a job is made of. Nothing is read, since a job that comes to another machine is unpacked before
        anyone there can be told that a file is missing."""
        board, photos = _images(shape), _images(grain)
        self._shape, self._field, self._stress, self._grain = shape, field, stress, grain
        self._text, self._name, self._folder = text, name, folder
        self._sets = sets
        self._file: bytes | None = None
        self._photos = board if photos is None else photos
        every: dict[str, Any] = {}
        if shape is not None:
            every.update(SHAPES)
        if isinstance(shape, (Mesh, Volume)):
            every["shape.ct.path" if isinstance(shape, Volume) else "shape.mesh"] = f"grainpath.{type(shape).__name__}"
        if board is not None:
            every["shape.photo.files"] = [image.name for image in board]
        if field is not None:
            self._file, of_field = field._file()
            every.update(of_field)
        if stress is not None:
            every.update({"guide.kind": "stress", "guide.import": "grainpath.Stress"})
        if photos is not None:
            every.update({"guide.kind": "grain", "guide.image.files": [image.name for image in photos]})
        for key in every.keys() & sets.keys() - MAY_DIFFER:
            if toml(every[key], key) != toml(sets[key], key):
                raise JobError(f"{key} = {sets[key]!r}: the job has an array for it; leave one of the two out")
        every.update(sets)
        self._lines = [f"{key}={toml(value, key)}" for key, value in every.items()]

    @functools.cached_property
    def _spec(self) -> _grainpath.Spec:
        """The settings as the planner has them."""
        try:
            return _grainpath.Spec(self._text, self._name, self._folder, self._lines)
        except JobError as error:
            # Settings are arguments here, and have no place in a file.
            message = str(error)
            if not message.startswith("--set: "):
                raise
            raise JobError(message.removeprefix("--set: ")) from None

    def _check_layers(self) -> None:
        """Sections are printed as they are: what would change a part is refused, so that nothing is ignored in silence."""
        settings = self.settings
        for key, plain in AS_THEY_ARE.items():
            if settings[key] != plain:
                raise JobError(f"{key} = {settings[key]}: sections are printed as they are; change the rings instead")
        # The rule of process.layer_height_mm, which sections overrule: the ends of a bead's section are round.
        assert isinstance(self._shape, LayerStack)
        width, height = settings["process.bead_width_mm"], float(self._shape.height_mm.max(initial=0.0))
        if width < height:
            raise JobError(
                f"process.bead_width_mm ({width:g}) should not be less than the layer height ({height:g}); height_mm of the "
                "LayerStack is thickest there"
            )

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str], **settings: Any) -> Job:
        """The job of a file. Paths in it are relative to its folder."""
        path = name_of(path)
        try:
            # As it is: ends of lines are part of a text of several, such as a start program.
            with open(path, encoding="utf-8", newline="") as file:
                text = file.read()
        except OSError as error:
            raise JobError(f"{path}: {(error.strerror or str(error)).lower()}", path) from error
        except UnicodeDecodeError as error:
            raise JobError(f"{path}: is not UTF-8 text", path) from error
        # Whoever plans it may stand in another folder.
        return cls(text=text, name=path, folder=os.path.dirname(os.path.abspath(path)), **settings)

    @classmethod
    def from_text(cls, text: str, *, folder: str | os.PathLike[str] = "", **settings: Any) -> Job:
        """The job of a text. Paths in it are relative to ``folder``.

        >>> import grainpath as gp
        >>> gp.Job.from_text("[fill]\\ndensity = 0.3")["fill.density"]
        0.3
        """
        return cls(text=text, folder=folder, **settings)

    def with_(
        self,
        shape: Shape | None = None,
        *,
        field: Field | None = None,
        stress: Stress | None = None,
        grain: Image | Sequence[Image] | None = None,
        **settings: Any,
    ) -> Job:
        """The same job with another shape, guide or settings. A field, a stress or a grain takes the place of the other.

        What is given here counts: an array takes the place of a file that was named before, and of the kind of the guide;
        a setting that names a file or another kind takes the place of an array.

        >>> import grainpath as gp
        >>> turned = gp.Job(gp.box(20, 10, 1), field=gp.Field(([0, 20], [0, 10]), [[0.6, 0.6], [0.6, 0.6]]))
        >>> turned.with_(guide__kind="none")["guide.kind"], turned["guide.kind"]
        ('none', 'field')
        """
        made = Job.__new__(Job)
        given, before = _sets(settings), dict(self._sets)
        if shape is not None:
            before = {key: value for key, value in before.items() if key not in SHAPES}
        elif not any(given.get(key) for key in SHAPES):
            shape = self._shape
        if field is not None or stress is not None or grain is not None:
            before = {key: value for key, value in before.items() if key not in GUIDES}
        else:
            kind = given.get("guide.kind")
            arrays = {"field": self._field, "stress": self._stress, "grain": self._grain}
            for name, array in arrays.items():
                if array is not None and kind in (None, name) and not any(given.get(key) for key in FILES_OF_GUIDES):
                    field, stress, grain = self._field, self._stress, self._grain
        made._build(shape, field, stress, grain, self._text, self._name, self._folder, {**before, **given})
        return made

    @property
    def shape(self) -> Shape | None:
        """The part, where it is no file."""
        return self._shape

    @property
    def settings(self) -> dict[str, Any]:
        """All settings in use, by name; ``None`` for what is not set."""
        return {key: _value(text) for key, text in self._spec.rows()}

    def __getitem__(self, key: str) -> Any:
        settings = self.settings
        if key not in settings:
            raise KeyError(f"no setting {key!r}{nearest(str(key), settings)}")
        return settings[key]

    def __contains__(self, key: object) -> bool:
        return key in self.settings

    def __iter__(self) -> Iterator[str]:
        """The names of all settings."""
        return iter(self.settings)

    @property
    def warnings(self) -> list[Warning]:
        """What was assumed or overruled while the job was read."""
        return warnings_of(self._spec.warnings())

    def plan(
        self, *, progress: Progress | None = None, cancel: Cancel | None = None, threads: int | None = None
    ) -> Plan:
        """Plans the job.

        ``progress(stage, done, total)`` is called in this thread, at most forty times a second. ``cancel`` is a token
        such as :class:`threading.Event`; once set, :class:`Cancelled` is raised. Ctrl-C raises ``KeyboardInterrupt``.
        The result does not depend on ``threads``. The interpreter's lock is free meanwhile.
        """
        return Plan._of(self, _grainpath.plan(*self._given(), _watch(threads, progress, cancel)))

    def check(
        self, *, progress: Progress | None = None, cancel: Cancel | None = None, threads: int | None = None
    ) -> Report:
        """Solves the loads and stops there: ``stress``, with what each fixture and load caught, and ``warnings``.

        It takes a part from a mesh or an outline, as ``grainpath run --check`` does.
        """
        watched = _watch(threads, progress, cancel)
        return Report("Loads", json.loads(_grainpath.check(*self._given(), watched)))

    def orient(
        self, *, progress: Progress | None = None, cancel: Cancel | None = None, threads: int | None = None
    ) -> Report:
        """Ranks the stable poses of the part: ``poses``, the best first, and ``warnings``.

        A pose has its ``rotate_deg``, the ``reserve`` under the loads of the job, ``support_g``, ``height_mm``, ``time_s``
        and the flat that the part stands on, as in ``docs/json.md``. Without loads, poses are ranked by support and
        height. It takes a part from a mesh or an outline, as ``grainpath orient`` does; loads that should turn with the
        part need ``guide__frame="part"``.

        >>> import grainpath as gp
        >>> job = gp.Job(gp.box(20, 10, 1))
        >>> best = job.orient()["poses"][0]
        >>> best["height_mm"], job.with_(shape__rotate_deg=best["rotate_deg"]).plan().report["layers"]
        (1.0, 5)
        """
        watched = _watch(threads, progress, cancel)
        return Report("Poses", json.loads(_grainpath.orient(*self._given(), watched)))

    def strength(
        self, *, progress: Progress | None = None, cancel: Cancel | None = None, threads: int | None = None
    ) -> Strength:
        """Plans the job and tests the part until it breaks; the job needs fixtures and loads. See :class:`Strength`."""
        watched = _watch(threads, progress, cancel)
        return Strength(_grainpath.strength(*self._given(), None, watched))

    def _strength_of(self, program: bytes, name: str, watched: tuple[Any, ...]) -> Strength:
        """The test of another slicer's program of this part."""
        return Strength(_grainpath.strength(*self._given(), (program, name), watched))

    def _without_shape(self) -> Job:
        """The settings alone, for those who have the part already."""
        folder = os.path.abspath(self._folder)
        return _again(None, self._field, self._stress, self._grain, self._text, self._name, folder, self._sets)

    def _given(self) -> tuple[_grainpath.Spec, Any]:
        shape = self._shape
        mesh = shape._data if isinstance(shape, Mesh) else None
        array = None
        if isinstance(shape, Volume):
            array = shape._given(shape._missing(lambda: self["shape.ct.window"]))
        layers = shape._data if isinstance(shape, LayerStack) else None
        photos = None if self._photos is None else [image._data for image in self._photos]
        stress = None if self._stress is None else self._stress._given()
        return self._spec, (mesh, array, layers, photos, self._file, stress)

    def __repr__(self) -> str:
        parts = [self._name] + ([repr(self._shape)] if self._shape is not None else [])
        return f"<grainpath.Job: {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        schema = _schema()
        rows = [("part", repr(self._shape) if self._shape is not None else "files of the job")]
        for key, value in self.settings.items():
            # What is as it is without a job says nothing of this one.
            if value is not None and value != schema.get(key, {}).get("default"):
                rows.append((key, str(value)))
        return table(f"Job {self._name}", rows)

    def __reduce__(self) -> tuple[Any, ...]:
        arrays = (self._shape, self._field, self._stress, self._grain)
        # Whoever unpacks it may stand in another folder.
        return _again, (*arrays, self._text, self._name, os.path.abspath(self._folder), self._sets)


def _images(given: Any) -> list[Image] | None:
    """The images of one or several; ``None`` for anything else."""
    if isinstance(given, Image):
        return [given]
    if isinstance(given, (list, tuple)) and given and all(isinstance(one, Image) for one in given):
        return list(given)
    return None


def _again(*parts: Any) -> Job:
    job = Job.__new__(Job)
    job._hold(*parts)
    return job


@functools.cache
def _schema() -> dict[str, dict[str, Any]]:
    """The schema of each setting, by name."""
    sections = json.loads(_grainpath.schema())["properties"]
    found: dict[str, dict[str, Any]] = {}

    def walk(name: str, node: dict[str, Any]) -> None:
        for key, inner in node.get("properties", {}).items():
            walk(f"{name}.{key}", inner)
        if "properties" not in node:
            found[name] = node

    for section, node in sections.items():
        walk(section, node)
    return found


def _value(text: str) -> Any:
    """A value of a setting as the planner shows it."""
    # Imported here, since a plan needs none of it.
    import tomllib

    try:
        return tomllib.loads(f"v = {text}")["v"]
    except tomllib.TOMLDecodeError:
        # What is not set is shown by a word.
        return None


def _watch(threads: int | None, progress: Progress | None, cancel: Cancel | None) -> tuple[Any, ...]:
    """What a call of the planner takes, looked at before it begins."""
    watch(progress, cancel)
    if threads is not None and not 1 <= whole(threads, "threads") <= 1024:
        raise JobError(f"threads = {threads} should be from 1 to 1024")
    return threads, progress, cancel


def _sets(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings by the names of the job file."""
    sets: dict[str, Any] = {}
    for given, value in settings.items():
        key = given.replace("__", ".")
        if "." not in key:
            raise JobError(f"{given}: a setting is its section, two underscores and its name, as fill__density")
        if key in SHORT and isinstance(value, (str, os.PathLike)):
            key = SHORT[key]
        sets[key] = value
    return sets
