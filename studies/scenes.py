"""The scene that a command is given: loaded, checked and changed."""

from studies.wanted_length import apart, with_wanted_lengths


def load(text):
    """Scene of a file, or by its name one that comes with the package."""
    from anet_lumped.checks import SceneError
    from anet_lumped.files.scene_file import load_scene
    from anet_lumped.model.build import build

    scene = load_scene(text)
    try:
        build(scene)  # here the effects find what they lack in a scene
    except SceneError as error:
        raise SceneError(f"{text}: {error}") from None
    return scene


def changed(scene, texts, added=()):
    """The scene with effects added, see `added_effects`, then NAME=VALUE put in, then lengths told by what they give at rest."""
    from studies.added_effects import with_effects
    from studies.sweeping.vary import SETTINGS, VaryError, apply, parse_vary, read_values

    scene = with_effects(scene, added)
    wanted, texts = apart(texts)
    values = read_values(scene, parse_vary(texts)) if texts else {}
    for name, given in values.items():
        if name in SETTINGS or len(given) != 1:
            raise VaryError(f"What is set must be one value of a field of the scene, but `{name}` was given {given}.")
    if values:
        scene = apply(scene, {name: given[0] for name, given in values.items()})[0]
    return with_wanted_lengths(scene, wanted)
