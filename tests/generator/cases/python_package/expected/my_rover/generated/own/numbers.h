// Generated from mapping.yaml; do not edit.
// Regenerate with: roverlink generate
// my_rover/generated
