"""The bench's circuits, one file each."""

import importlib

NAMES = ["axis", "tanks", "dead_zone", "cylinder", "load_rig", "closed_circuit", "servo_axis", "hyd"]


def circuits(only=None):
    """The circuits that can be made here, in fixed order; those whose model is not there are left out."""
    found = []
    for name in [only] if only else NAMES:
        circuit = importlib.import_module(f"circuits.{name}").circuit()
        if circuit is not None:
            found.append(circuit)
    return found
