"""Panoramic cameras as parameters of a spherical one."""

import math

from mathutils import Matrix

ROUNDING = 1e-3  # degrees

FISHEYES = {"FISHEYE_EQUIDISTANT": "equidistant", "FISHEYE_EQUISOLID": "equisolid"}


def _settings(data):
    """Who has the settings of panoramas: Blender 5 itself, before it Cycles."""
    return data if hasattr(data, "panorama_type") else getattr(data, "cycles", None)


def is_fisheye(data):
    return getattr(_settings(data), "panorama_type", "") in FISHEYES


def _longitudes(of):
    """The western and eastern border of what is shown, in degrees as pbrt's map has them, 180 straight ahead; they may lie beyond 0 to 360."""
    return tuple(180 + math.degrees(angle) for angle in (of.longitude_min, of.longitude_max))


def _is_beyond(west, east):
    return west < -ROUNDING or east > 360 + ROUNDING


def turned(data, turn):
    """The camera's axes by which longitudes that reach around behind the camera, beyond 0 or 360 degrees, begin at 0; else `turn`."""
    of = _settings(data)
    if getattr(of, "panorama_type", "") != "EQUIRECTANGULAR":
        return turn
    west, east = _longitudes(of)
    if not _is_beyond(west, east):
        return turn
    return Matrix.Rotation(math.radians(math.fmod(west, 360)), 4, "Y") @ turn


def left_out_of_panorama(data):
    """Warnings of what a panoramic camera has without counterpart."""
    found = []
    if data.dof.use_dof:
        found.append("the camera's depth of field is left out, as it is a panorama")
    if data.shift_x or data.shift_y:
        found.append("the camera's shift is left out, as it is a panorama")
    if is_fisheye(data) and _settings(data).fisheye_fov > 2 * math.pi + ROUNDING:
        found.append("the camera's fisheye goes around more than once and ends at 360 degrees")
    return found


def panorama_text(data, size):
    """The parameters of a panoramic camera for a frame of this size, its sides in the same unit. RuntimeError for those without
    counterpart."""
    of = _settings(data)
    kind = getattr(of, "panorama_type", "")
    if kind == "EQUIRECTANGULAR":
        west, east = _longitudes(of)
        south, north = (math.degrees(angle) for angle in (of.latitude_min, of.latitude_max))
        if not (west < east and south < north):
            raise RuntimeError("covtrace: the camera's panorama is mirrored: expected a smaller minimum than maximum of latitude and longitude")
        if east - west > 360 + ROUNDING:
            raise RuntimeError("covtrace: the camera's panorama goes around more than once: expected longitudes at most 360 degrees apart")
        if _is_beyond(west, east):
            west, east = 0, east - west
        return f'"string mapping" "equirectangular" "float longitude" [{max(west, 0):.7g} {min(east, 360):.7g}] ' \
               f'"float latitude" [{max(south, -90):.7g} {min(north, 90):.7g}]'
    if kind not in FISHEYES:
        raise RuntimeError(f"covtrace: panoramas of the type {kind} are not supported; expected equirectangular ones or fisheyes")
    fov = min(of.fisheye_fov, 2 * math.pi)  # Cycles goes around more than once
    x, y = _half_frame(data, of.fisheye_lens, fov, size) if kind == "FISHEYE_EQUISOLID" else 2 * (of.fisheye_fov / fov,)
    return f'"string mapping" "{FISHEYES[kind]}" "float fov" {math.degrees(fov):.9g} ' \
           f'"float screenwindow" [{-x:.9g} {x:.9g} {-y:.9g} {y:.9g}]'


def _half_frame(data, lens, fov, size):
    """Half the frame's sides over the radius of its circle, from the lens and the sensor, both in mm."""
    radius = 2 * lens * math.sin(fov / 4)
    width, height = size
    is_width = data.sensor_fit == "HORIZONTAL" or data.sensor_fit == "AUTO" and width >= height
    of_sensor = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    half = of_sensor / 2 / radius
    return (half, half * height / width) if is_width else (half * width / height, half)
