"""Roles: the meaning of a variable to those who know no component by name.

Metrics, the balance of energy, tables and pictures of a run ask for variables by their role, so
that a new component takes part in them by its declarations alone. Roles are ordered by their dots:
whoever asks for ``energy.kinetic`` gets ``energy.kinetic.striking`` too.
"""

from enum import StrEnum


class Role(StrEnum):
    """Role of a variable. Those of parameters stand last."""

    KINETIC = "energy.kinetic"
    """Kinetic energy (J)."""
    STRIKING = "energy.kinetic.striking"
    """Kinetic energy (J) of a body that strikes: at the start, or when it is handed over, it is the
    impact energy."""
    GRAVITY_ENERGY = "energy.gravity"
    """Potential energy (J) in gravity; its zero is arbitrary."""
    ELASTIC = "energy.elastic"
    """Energy (J) stored otherwise, to be given back: in springs, in capillary bridges."""
    ESTIMATED = "energy.estimated"
    """Elastic energy (J) of a structure as a gauge lets it be estimated; no part of the balance."""
    DISSIPATED = "energy.dissipated"
    """Energy (J) dissipated since the start."""
    PLASTIC = "energy.dissipated.plastic"
    """Energy (J) dissipated in a structure by what yields, since the start."""
    LEFT_BEHIND = "energy.dissipated.on_the_way"
    """Energy (J) dissipated on the way to the system, which may have begun before it; its zero is
    arbitrary."""
    WORK_INSIDE = "energy.work.inside"
    """Work (J) that another component has done on this one through an interface."""
    WORK_OUTSIDE = "energy.work.outside"
    """Work (J) that comes from outside the system: of a weight."""
    MACHINE_WORK = "energy.work.outside.machine"
    """Work (J) of a machine that drives a body."""
    RESIDUAL = "energy.residual"
    """Energies + dissipated - works of a component, less their sum at the start (J): the error of
    its balance."""

    TRANSMITTED = "force.transmitted"
    """Force (N) of a cushion on what carries it, downwards."""
    ON_STRUCTURE = "force.on_structure"
    """Forces (N) of a cushion on the elements of what carries it, upwards, an array along it."""
    BOX_INERTIA = "force.box_inertia"
    """Force (N), downwards, that accelerates what stands between cushion and structure: a load cell
    under it shows the transmitted force less this."""
    ON_BODY = "force.on_body"
    """Force (N) of a cushion on the body that strikes it, upwards."""
    PENETRATION = "penetration"
    """Depth (m) of the striking body's lowest point under the mean level of the cushion's surface
    at the start; 0 until it first touches, and above."""
    ABOVE_SURFACE = "height.above_surface"
    """Height (m) of the striking body's lowest point above the mean level of the cushion's surface
    at the start; negative below it."""
    SURFACE = "height.surface"
    """Height (m) of the cushion's surface under the striking body at the start."""
    CLEARANCE = "clearance"
    """Distance (m) of the striking body's surface from what the cushion rests on; negative where it
    presses into it."""
    STRUCTURE = "height.structure"
    """Heights (m) of the axis of a structure, an array along it."""
    ALONG = "place.along"
    """Places (m) of the elements of a structure, an array along it."""
    DEFLECTION = "deflection"
    """Deflection (m) of a structure, downwards."""
    BENDING_MOMENT = "moment.bending"
    """Bending moment (N m) in a structure, positive with tension below, a scalar or an array."""
    SHEAR = "force.shear"
    """Shear force (N) in a structure, the rate of its bending moment along it, a scalar or an
    array."""
    PLASTIC_CURVATURE = "curvature.plastic"
    """Plastic part (1/m) of the curvature of a structure, an array along it."""
    CURVATURE_RATIO = "curvature.ratio"
    """Largest curvature of a structure so far, as a multiple of that of the last corner of its
    moment-curvature line; 0 for one that does not yield."""
    RESIDUAL_DEFLECTION = "residual_deflection"
    """Deflection (m) that would stay in a structure if all loads were taken from it, downwards."""
    SUPPORT_FORCE = "force.on_support"
    """Vertical force (N) of a structure on its supports, upwards, a scalar or an array."""
    UNBALANCED = "unbalanced_force_ratio"
    """How far a cushion was from rest at the start, as a part of gravity."""
    HANDED_OVER = "motion.handed_over"
    """Whether a body is handed over to the system."""
    LOADED_POSITION = "position.loaded"
    """Way (m) of the point on which the load at rest acts, in the direction of that load."""

    STRIKING_PLACE = "position.striking"
    """Horizontal position (m) of the centre of a body that strikes."""

    DRIVEN = "motion.driven"
    """Parameter: ``driven`` or true where a machine moves the body."""
    BODY_MASS = "body.mass"
    """Parameter: mass (kg) of a body that strikes."""
    BODY_RADIUS = "body.radius"
    """Parameter: radius (m) of a body that strikes."""
    GRAVITY = "gravity"
    """Parameter: acceleration of gravity (m/s2)."""
    EFFECTIVE_WIDTH = "width.effective"
    """Parameter: width (m) of a cushion out of the plane."""
    GRAIN_RADIUS = "grain.radius"
    """Parameter: radius (m) of the grains or discs of a cushion."""
    BOX_LEFT = "box.left"
    """Parameter: x (m) of the left side of the box that a cushion lies in."""
    BOX_WIDTH = "box.width"
    """Parameter: width (m) of that box."""
    CUSHION_WEIGHT = "weight.cushion"
    """Parameter: weight (N) of the cushion under which a structure is bent at the start."""
    SECOND_MOMENT = "section.second_moment"
    """Parameter: second moment of area (m4) of the whole section of a structure."""
    SECTION_HEIGHT = "section.height"
    """Parameter: height (m) of the section of a structure, its axis at half of it."""
    LOAD_AT_REST = "load.at_rest"
    """Parameter: load (N) that a component carries at rest and leaves out of its balance."""
    INTERNAL_STEP = "step.internal"
    """Parameter: longest time step (s) inside a component."""

    def includes(self, other: str) -> bool:
        """Return whether a role is this one or a kind of it.

        Parameters
        ----------
        other : str
            The other role; empty for a variable without one.
        """
        return other == self or other.startswith(f"{self}.")
