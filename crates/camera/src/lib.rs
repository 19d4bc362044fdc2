//! Pinhole cameras with lens distortion, and rigs of calibrated cameras
