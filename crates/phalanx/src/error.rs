//! What can be wrong with training, models and pictures.

use glam::DVec2;

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No silhouette could be had from a camera's picture.
    #[error("camera '{camera}': {reason}")]
    Silhouette {
        /// The camera's name.
        camera: String,
        /// The reason.
        reason: phalanx_segmentation::Error,
    },
    /// A hand at whose place the lens has no room for a window.
    #[error(
        "camera '{camera}': there is no window on the hand: the lens maps nothing to {pixel} px"
    )]
    NoWindow {
        /// The camera's name.
        camera: String,
        /// A place that the window would show, px of the picture.
        pixel: DVec2,
    },
    /// A segmentation that says nothing of a camera's pictures.
    #[error("camera '{camera}': nothing says how to tell the hand from the rest of its pictures")]
    NoSegmenter {
        /// The camera's name.
        camera: String,
    },
    /// No camera sees anything like a hand, in any frame.
    #[error(
        "no camera sees anything like a hand; in masks it is brighter than 127, in photographs it must have the colour \
         that it is looked for by"
    )]
    NoHand,
    /// A frame that does not come after the one before it.
    #[error(
        "a frame of {time} s comes after one of {before} s; frames are given in the order of time"
    )]
    FrameTime {
        /// Its time, seconds.
        time: f64,
        /// The time of the frame before it.
        before: f64,
    },
    /// A frame without a time, where the other frames have one or each needs one.
    #[error("{} has no time; `TakeFrame::at` gives it one", frame_of(*.frame))]
    NoFrameTime {
        /// Its number in the take, from 0; `None` of a stream.
        frame: Option<usize>,
    },
    /// A hand that would be behind a camera that sees it.
    #[error("camera '{camera}': the hand would be behind it")]
    BehindCamera {
        /// The camera's name.
        camera: String,
    },
    /// A silhouette has no shape contexts.
    #[error("camera '{camera}': {reason}")]
    ShapeContext {
        /// The camera's name.
        camera: String,
        /// The reason.
        reason: phalanx_shape_context::Error,
    },
    /// A training pose that some camera cannot see whole enough to be described.
    #[error("training pose {pose}: {reason}")]
    TrainingPose {
        /// Its position in the list of poses, from 0.
        pose: usize,
        /// The reason.
        reason: Box<Error>,
    },
    /// A hand could not be drawn.
    #[error("camera '{camera}': {reason}")]
    Render {
        /// The camera's name.
        camera: String,
        /// The reason.
        reason: phalanx_render::Error,
    },
    /// The rig is unusable.
    #[error(transparent)]
    Rig(#[from] phalanx_camera::Error),
    /// The hand is unusable.
    #[error(transparent)]
    Hand(#[from] phalanx_hand::Error),
    /// The hand could not be fitted to silhouettes.
    #[error(transparent)]
    Refine(#[from] phalanx_refine::Error),
    /// The views could not be joined.
    #[error(transparent)]
    Views(#[from] phalanx_multiview::Error),
    /// The regressor could not be fitted or does not fit the descriptor.
    #[error(transparent)]
    Regression(#[from] phalanx_rvm::Error),
    /// Hypotheses were asked of an estimator that does not know how its estimates err.
    #[error("the estimator has not learnt how its estimates err, so it has no hypotheses")]
    NoErrorModel,
    /// A codebook of something other than shape contexts.
    #[error(
        "camera '{camera}': its codebook is of {found} bins where shape contexts have {expected}"
    )]
    CodebookBins {
        /// The camera's name.
        camera: String,
        /// The codebook's bins.
        found: usize,
        /// The bins of a shape context.
        expected: usize,
    },
    /// A part of an estimator that does not fit the others.
    #[error("{found} {part} where there should be {expected}")]
    Mismatch {
        /// What there are too few or too many of.
        part: &'static str,
        /// How many there are.
        found: usize,
        /// How many the other parts ask for.
        expected: usize,
    },
    /// A regressor whose arithmetic overflows.
    #[error("the regressor predicts {value} for {dof}")]
    Overflow {
        /// The number of the pose, by name.
        dof: &'static str,
        /// What was predicted for it, or its standard deviation.
        value: f64,
    },
    /// A regressor that works from sums over scenes, and from nothing else.
    #[error("{regressor} learns from scenes that stream by, not from descriptors at once")]
    InShardsOnly {
        /// The regressor.
        regressor: &'static str,
    },
    /// No pose to learn from, or only one.
    #[error("{found} training poses are too few: at least 2 are needed")]
    TooFewPoses {
        /// How many there are.
        found: usize,
    },
    /// A given training pose that some camera cannot see whole enough to be described.
    #[error("training pose {pose}: {reason}")]
    LostPose {
        /// Its position in the list of poses, from 0.
        pose: usize,
        /// The camera and the reason.
        reason: String,
    },
    /// More training samples than a regressor takes that keeps them all.
    #[error(
        "{regressor} keeps all samples and takes at most {most}, not {found}; learn from fewer, or by a \
         preset or Nyström's regression, which take any number"
    )]
    TooManySamples {
        /// The regressor.
        regressor: &'static str,
        /// How many there are.
        found: usize,
        /// How many it takes.
        most: usize,
    },
    /// More training scenes than can be done without that some camera does not show.
    #[error(
        "{lost} of {scenes} training scenes cannot be used, more than {} %: {losses}; check where the rig's \
         working volume and cameras are",
        100.0 * most
    )]
    TooManyLost {
        /// How many are lost.
        lost: usize,
        /// Of how many.
        scenes: usize,
        /// The largest share that is borne.
        most: f64,
        /// The cameras and reasons.
        losses: String,
    },
    /// Not one picture per camera.
    #[error(
        "expected one picture per camera, {} ({}), found {found}",
        cameras.len(), cameras.join(", ")
    )]
    PictureCount {
        /// The model's cameras in the order in which pictures are expected.
        cameras: Vec<String>,
        /// How many pictures were given.
        found: usize,
    },
    /// A frame with landmarks of other than its cameras.
    #[error(
        "expected landmarks, or none, of each camera, {} ({}), found {found}",
        cameras.len(), cameras.join(", ")
    )]
    LandmarkCount {
        /// The cameras in the order in which landmarks are expected.
        cameras: Vec<String>,
        /// How many of them landmarks were given for.
        found: usize,
    },
    /// A camera that shows no hand to an estimator that needs every camera's view.
    #[error(
        "camera '{camera}': nothing is seen of the hand, and the model was not learnt to do without it; a \
         model of a preset does"
    )]
    MissingCamera {
        /// The camera's name.
        camera: String,
    },
    /// A picture whose shape is not that of its camera's image.
    #[error(
        "camera '{camera}': the picture is {}×{}, which is not the shape of the camera's {}×{}; \
         crop it to that shape",
        found.0, found.1, expected.0, expected.1
    )]
    PictureShape {
        /// The camera's name.
        camera: String,
        /// Width and height of the picture, px.
        found: (u32, u32),
        /// Width and height of the camera's image, px.
        expected: (u32, u32),
    },
    /// A JPEG file without its end.
    #[error("the JPEG file is truncated")]
    TruncatedPicture,
    /// A picture that takes too much memory.
    #[error(
        "a picture of {width}×{height} px takes {} MiB to decode, {} MiB are allowed; scale it down",
        needed.div_ceil(1 << 20), most >> 20
    )]
    LargePicture {
        /// Its width, px.
        width: u32,
        /// Its height, px.
        height: u32,
        /// What decoding it takes, bytes.
        needed: u64,
        /// What it may take, bytes.
        most: u64,
    },
    /// A file that is no picture, a damaged one, or one with too long a side.
    #[error("{reason}")]
    Undecodable {
        /// What is wrong with it.
        reason: String,
    },
    /// The bytes are not a file of this project.
    #[error("not a phalanx {what}: the file does not begin with its mark")]
    ForeignFile {
        /// What was to be read.
        what: &'static str,
    },
    /// A file of a format that this version does not read.
    #[error(
        "the {what} has format {found}; this version reads format {known}: train again, or use the \
         version that wrote it"
    )]
    FileVersion {
        /// What was to be read.
        what: &'static str,
        /// The file's format.
        found: u32,
        /// The format that is read.
        known: u32,
    },
    /// A file that is shorter or longer than its header says.
    #[error(
        "the {what} file is truncated or has been added to: {found} bytes where its header says {expected}"
    )]
    FileLength {
        /// What was to be read.
        what: &'static str,
        /// Bytes announced.
        expected: u64,
        /// Bytes present.
        found: u64,
    },
    /// A file whose checksum does not match.
    #[error(
        "the {what} file is corrupt: checksum {found:08x} where its header says {expected:08x}"
    )]
    FileChecksum {
        /// What was to be read.
        what: &'static str,
        /// Checksum announced.
        expected: u32,
        /// Checksum computed.
        found: u32,
    },
    /// A file whose content cannot be decoded or contradicts itself.
    #[error("the {what} file is corrupt: {reason}")]
    FileContent {
        /// What was to be read.
        what: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A shard that there is not.
    #[error("there is no shard {index} of {count}: they are numbered from 1 to {count}")]
    Shard {
        /// Its number.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Text that names no shard.
    #[error("'{text}' is no shard: write i/n, such as 1/4")]
    NoShard {
        /// The text.
        text: String,
    },
    /// Parts of different trainings.
    #[error("the parts are not of one training: they differ in {what}")]
    ForeignPart {
        /// What they differ in.
        what: &'static str,
    },
    /// Parts that hold the same samples.
    #[error("two parts both hold samples {first} to {last}")]
    Overlap {
        /// The first sample that both hold.
        first: usize,
        /// The last one of its block.
        last: usize,
    },
    /// Samples that no part holds.
    #[error("a part is missing: none holds samples {first} to {last}")]
    MissingPart {
        /// The first missing sample.
        first: usize,
        /// The last one of its block.
        last: usize,
    },
}

/// A result of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

fn frame_of(number: Option<usize>) -> String {
    number.map_or_else(|| "a frame".to_owned(), |number| format!("frame {number}"))
}
