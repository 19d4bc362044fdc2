//! The names that tools and people give to the fields of a camera.

/// What a key stands for, by its letters and digits in lower case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Field {
    Name,
    Size,
    Width,
    Height,
    Matrix,
    /// fx, fy, cx or cy.
    MatrixElement,
    Distortion,
    /// A single coefficient.
    Coefficient,
    Model,
    Fisheye,
    Rotation,
    Translation,
    /// A matrix of 3×4 or 4×4, from the world to the camera.
    CameraFromWorld,
    /// The same of the camera in the world.
    WorldFromCamera,
    /// A pose of which the name does not say which way it goes, or that has other axes.
    AmbiguousPose,
    Ignore,
    Turns,
    /// Of no matter for a camera.
    Passed,
    Unknown,
}

impl Field {
    pub(super) fn of(key: &str) -> Self {
        let plain: String = key.chars().filter(|c| c.is_alphanumeric()).collect();
        match plain.to_lowercase().as_str() {
            "name" | "camid" | "cameraname" | "cameraid" | "port" | "label" => Self::Name,
            "size" | "imagesize" | "imgsize" | "resolution" | "imageresolution" | "framesize"
            | "calibrationsize" => Self::Size,
            "width" | "imagewidth" | "imgwidth" | "w" => Self::Width,
            "height" | "imageheight" | "imgheight" | "h" => Self::Height,
            "matrix" | "cameramatrix" | "k" | "m" | "cm" | "mtx" | "kmatrix" | "kmtx"
            | "intrinsic" | "intrinsics" | "intrinsicmatrix" | "intrinsicmat"
            | "intrinsicsmatrix" | "calibrationmatrix" => Self::Matrix,
            "fx" | "fy" | "cx" | "cy" => Self::MatrixElement,
            "distortion"
            | "distortions"
            | "distortioncoefficients"
            | "distortioncoeffs"
            | "distortioncoefs"
            | "distcoeffs"
            | "distcoefs"
            | "distcoef"
            | "distcoeff"
            | "dist"
            | "d"
            | "kc"
            | "distortionvector" => Self::Distortion,
            "k1" | "k2" | "k3" | "k4" | "k5" | "k6" | "p1" | "p2" => Self::Coefficient,
            "model" | "cameramodel" | "distortionmodel" | "lens" | "lensmodel" | "lenstype"
            | "projection" | "projectionmodel" | "projectiontype" | "cameratype" | "modeltype"
            | "distortiontype" => Self::Model,
            "fisheye" | "isfisheye" | "usefisheye" => Self::Fisheye,
            "rotation" | "r" | "rot" | "rmat" | "rotationmatrix" | "rvec" | "rotationvector"
            | "rodrigues" | "rvecs" => Self::Rotation,
            "translation" | "t" | "tvec" | "translationvector" | "trans" | "tvecs" => {
                Self::Translation
            }
            "extrinsic" | "extrinsics" | "extrinsicmatrix" | "extrinsicsmatrix" | "rt"
            | "worldtocamera" | "worldtocam" | "world2camera" | "world2cam" | "w2c"
            | "tcamworld" | "tcw" | "camerafromworld" | "camfromworld" => Self::CameraFromWorld,
            "cameratoworld" | "camtoworld" | "camera2world" | "cam2world" | "c2w" | "tworldcam"
            | "twc" | "worldfromcamera" | "worldfromcam" => Self::WorldFromCamera,
            "pose" | "camerapose" | "campose" | "transform" | "transformmatrix" | "position"
            | "camerapositions" | "cameraposition" | "orientation" | "location" | "quaternion"
            | "center" | "centre" | "cameracenter" | "viewmatrix" | "euler" | "eulerangles"
            | "qvec" => Self::AmbiguousPose,
            "ignore" => Self::Ignore,
            "rotationcount" => Self::Turns,
            "id"
            | "index"
            | "error"
            | "exposure"
            | "gridcount"
            | "worldposition"
            | "worldorientation"
            | "reprojectionerror"
            | "reprojectionerrorpx"
            | "rms"
            | "rmse"
            | "avgreprojectionerror"
            | "rostopic"
            | "camoverlaps"
            | "timeshiftcamimu"
            | "tcamimu"
            | "rectificationmatrix"
            | "projectionmatrix"
            | "panel"
            | "node"
            | "type"
            | "comment"
            | "note"
            | "fps"
            | "serial"
            | "calibrationtime"
            | "nframes"
            | "typeid" => Self::Passed,
            _ => Self::Unknown,
        }
    }
}
