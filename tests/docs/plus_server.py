#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a PLUS server would send of a tracker CSV, over and over, 40 times a second: plus_server.py RECORDING.

OpenIGTLink version 1, a TRANSFORM `<sensor>ToTracker` a reading; what is MISSING is not sent. The first line that it prints is its port.
"""

import csv
import itertools
import socket
import struct
import sys
import threading
import time

PERIOD_S = 0.025
POLYNOMIAL, MASK = 0x42F0E1EBA9EA3693, 0xFFFFFFFFFFFFFFFF  # ECMA-182, as the protocol has it


def crc64(data):
    value = 0
    for byte in data:
        value ^= byte << 56
        for _ in range(8):
            value = ((value << 1) ^ (POLYNOMIAL if value >> 63 else 0)) & MASK
    return value


def rotation_columns(w, x, y, z):
    """Of a unit quaternion."""
    return (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),
            2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
            2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))


def message(device, body, stamp):
    """Header and body; the stamp counts 2^-32 s since 1970 and is the same in all messages of a frame."""
    return struct.pack(">H12s20sQQQ", 1, b"TRANSFORM", device.encode(), stamp, len(body), crc64(body)) + body


def read_frames(path):
    """Of every frame the devices and bodies of its readings."""
    with open(path, newline="", encoding="utf-8") as file:
        for _, rows in itertools.groupby(csv.DictReader(file), key=lambda row: row["frame"]):
            yield [(row["sensor"] + "ToTracker",
                    struct.pack(">12f", *rotation_columns(*(float(row[q]) for q in ("q0", "qx", "qy", "qz"))),
                                *(float(row[t]) for t in ("tx_mm", "ty_mm", "tz_mm"))))
                   for row in rows if row["status"] == "OK"]


def play(client, frames):
    """To one client, until he goes."""
    try:
        for readings in itertools.cycle(frames):
            stamp = int(time.time() * 2**32)
            client.sendall(b"".join(message(device, body, stamp) for device, body in readings))
            time.sleep(PERIOD_S)
    except OSError:
        client.close()


def main(path):
    assert crc64(b"123456789") == 0x6C40DF5F0B497347  # the check value of CRC-64/ECMA-182
    frames = list(read_frames(path))
    server = socket.create_server(("127.0.0.1", 0))
    print(server.getsockname()[1], flush=True)
    while True:
        client, _ = server.accept()
        threading.Thread(target=play, args=(client, frames), daemon=True).start()


if __name__ == "__main__":
    main(sys.argv[1])
