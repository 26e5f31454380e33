// Generated from mapping.yaml; do not edit.
// Regenerate with: roverlink generate
#pragma once

#define PROBE_NUMBER 1
