"""COHELM_SECRET=... python examples/markers_to_lsl.py --server ws://127.0.0.1:8080

Writes the markers of a study into a Lab Streaming Layer stream (docs/markers.md). Needs pylsl and websocket-client.
"""

import argparse
import json
import os
import sys
import time

FIRST_WAIT_S, LONGEST_WAIT_S = 1.0, 30.0


def lsl_time(t_server_ms: float, lsl_now: float, system_now: float) -> float:
    """The time of LSL's clock at a moment that the system's clock names, given both at the same moment (s)."""
    return lsl_now + (t_server_ms / 1000.0 - system_now)


def outlet(pylsl):
    """A stream of one text channel, whose samples come when something happens."""
    info = pylsl.StreamInfo("cohelm", "Markers", 1, pylsl.IRREGULAR_RATE, pylsl.cf_string, "cohelm-markers")
    info.desc().append_child_value("format", "JSON, see docs/markers.md")
    return pylsl.StreamOutlet(info)


def forward(line: str, out, pylsl) -> None:
    """Puts one marker into the stream."""
    marker = json.loads(line)
    now = time.time()
    at_ms = marker.get("t_server_ms", now * 1000.0)
    out.push_sample([line], lsl_time(at_ms, pylsl.local_clock(), now))
    print(line, flush=True)


def listen(server: str, secret: str, out, pylsl, websocket) -> None:
    """Forwards until the connection ends."""
    header = [f"Authorization: Bearer {secret}"]
    socket = websocket.create_connection(
        f"{server}/ws/markers", header=header, suppress_origin=True, timeout=10
    )
    socket.settimeout(None)
    try:
        while line := socket.recv():
            forward(line, out, pylsl)
    finally:
        socket.close()


def main() -> int:
    parser = argparse.ArgumentParser(description="Markers of a study as a Lab Streaming Layer stream")
    parser.add_argument("--server", default="ws://127.0.0.1:8080", help="ws:// or wss:// address of the server")
    server = parser.parse_args().server.rstrip("/")
    secret = os.environ.get("COHELM_SECRET")
    if not secret:
        print("set COHELM_SECRET to the secret of the researcher's page", file=sys.stderr)
        return 2
    # After the options, so that --help needs neither.
    import pylsl
    import websocket

    out, wait_s = outlet(pylsl), FIRST_WAIT_S
    while True:
        try:
            began = time.monotonic()
            listen(server, secret, out, pylsl, websocket)
        except websocket.WebSocketBadStatusException as refused:
            if refused.status_code == 401:
                print("that is not the secret, or no study is run there", file=sys.stderr)
                return 1
            print(refused, file=sys.stderr)
        except (OSError, websocket.WebSocketException) as lost:
            print(f"{lost}; connecting again in {wait_s:.0f} s", file=sys.stderr)
        wait_s = FIRST_WAIT_S if time.monotonic() - began > LONGEST_WAIT_S else min(2 * wait_s, LONGEST_WAIT_S)
        time.sleep(wait_s)


if __name__ == "__main__":
    sys.exit(main())
