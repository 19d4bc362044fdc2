//! Joint angles of a bare hand from one or more calibrated cameras
