"""A camera on the network that speaks RTSP, made of GStreamer's server; run by the Python that has its bindings.

/usr/bin/python3 rtsp_server.py PORT prints "ready"; the stream is rtsp://127.0.0.1:PORT/live.
"""

import sys

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # noqa: E402  # only after require_version

Gst.init(None)
if not (Gst.ElementFactory.find("rtpjpegpay") and Gst.ElementFactory.find("jpegenc")):
    sys.exit("the plugins of GStreamer are missing")
server = GstRtspServer.RTSPServer()
server.set_address("127.0.0.1")
server.set_service(sys.argv[1])
factory = GstRtspServer.RTSPMediaFactory()
factory.set_launch(
    "( videotestsrc is-live=true pattern=green ! video/x-raw,format=I420,width=320,height=240,framerate=30/1 ! jpegenc "
    "! rtpjpegpay name=pay0 )"
)
factory.set_shared(True)
server.get_mount_points().add_factory("/live", factory)
server.attach(None)
print("ready", flush=True)
GLib.MainLoop().run()
