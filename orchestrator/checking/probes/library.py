"""Probes of the library: whether it can be loaded, and for whom it makes instances."""

import shutil

from ..subject.calls import CannotLoad, NoInstance
from ..subject.subject import Subject
from ..verdicts import Seen, failed, passed

_WITH_SPACES = "a folder with spaces"
_WITH_LETTERS = "Ordner-ä-é-日本"
_ODD_NAMES = ("100% %s %n %d", "ä é 日本", "x" * 4096)


def loads(subject: Subject) -> Seen:
    """Load the library with all of its functions."""
    try:
        dll = subject.dll
    except CannotLoad as error:
        return failed(str(error), "export it again for this machine, with every function of FMI")
    prefix = f"fmi{subject.version}"
    names = [name for name in vars(dll) if name.startswith(prefix)]
    return passed(f"loaded, with {len(names)} functions of FMI")


def version(subject: Subject) -> Seen:
    """Compare the version that the library tells with that of the description."""
    told = getattr(subject.dll, f"fmi{subject.version}GetVersion")().decode()
    declared = subject.model.fmiVersion
    if not told.startswith(declared[:3]):
        return failed(
            f"the library is of FMI {told}, the description of FMI {declared}",
            "export both in one go",
        )
    if subject.version == 2 and (platform := subject.dll.fmi2GetTypesPlatform()) != b"default":
        return failed(f"its types are {platform.decode()}, not default", "compile it with FMI's")
    return passed(f"the library is of FMI {told}, as the description")


def token(subject: Subject) -> Seen:
    """Ask for an instance with a wrong GUID or token, and an empty one."""
    word = "GUID" if subject.version == 2 else "instantiation token"
    for wrong in ("{00000000-0000-0000-0000-000000000000}", ""):
        if subject.has_instance(wrong):
            return failed(
                f"an instance is made for a wrong {word}: library and description of different "
                "exports are not told apart",
                f"compare the {word} when an instance is made, and make none",
            )
    return passed(f"no instance for a wrong {word}")


def spaces(subject: Subject) -> Seen:
    """Run in a folder whose name has spaces."""
    return _in_folder(subject, _WITH_SPACES)


def letters(subject: Subject) -> Seen:
    """Run in a folder whose name has letters beyond ASCII."""
    return _in_folder(subject, _WITH_LETTERS)


def _in_folder(subject: Subject, name: str) -> Seen:
    folder = subject.shared / name
    shutil.copytree(subject.folder, folder)
    there = Subject(subject.file, folder, subject.shared, subject.shared / "trail", subject.step)
    there.trail = subject.trail
    try:
        instance = there.begun()
        instance.step(there.step)
        instance.terminate()
        instance.free()
    except (NoInstance, CannotLoad) as error:
        return failed(
            f"no instance in the folder '{name}': {error}",
            "decode the URI of the resources: its %20 and the like are letters in UTF-8",
        )
    return passed(f"runs in the folder '{name}'")


def odd_name(subject: Subject) -> Seen:
    """Simulate with odd names of the instance, which messages show."""
    for name in _ODD_NAMES:
        instance = subject.begun(name)
        instance.step(subject.step)
        instance.terminate()
        instance.free()
    return passed("percent signs, other letters and 4096 characters do no harm")
