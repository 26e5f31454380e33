"""H.264 video over the network: RTP and RTCP packets, encoding and decoding, and the control of the bitrate."""
