//! Exact area averages.

use image::RgbImage;

use crate::mask::Mask;

use crate::error::{Error, Result};

/// The part of an image that down-sampling keeps, in whole pixels of the source.
///
/// A point (x, y) of the source is at ((x − window.x) · w / window.width,
/// (y − window.y) · h / window.height) in the w × h target; a camera's focal lengths and principal
/// point change alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CropWindow {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// Width.
    pub width: u32,
    /// Height.
    pub height: u32,
}

impl CropWindow {
    /// The largest centred window of a `source` image with the shape of the `target`, both (width,
    /// height) in pixels. The shorter side is rounded to whole pixels, the offset down.
    ///
    /// ```
    /// use phalanx_segmentation::CropWindow;
    ///
    /// let window = CropWindow::centred((1920, 1080), (120, 90))?;
    /// assert_eq!((window.x, window.y, window.width, window.height), (240, 0, 1440, 1080));
    /// # Ok::<(), phalanx_segmentation::Error>(())
    /// ```
    pub fn centred(source: (u32, u32), target: (u32, u32)) -> Result<Self> {
        for (width, height) in [source, target] {
            if width == 0 || height == 0 {
                return Err(Error::ImageTooSmall { width, height, minimum: 1 });
            }
        }
        let [sw, sh, tw, th] = [source.0, source.1, target.0, target.1].map(u64::from);
        let rounded = |numerator: u64, denominator: u64| {
            ((2 * numerator + denominator) / (2 * denominator)).max(1) as u32
        };
        let (width, height) = if sw * th > sh * tw {
            (rounded(sh * tw, th).min(source.0), source.1)
        } else {
            (source.0, rounded(sw * th, tw).min(source.1))
        };
        Ok(Self { x: (source.0 - width) / 2, y: (source.1 - height) / 2, width, height })
    }
}

/// The average colour of the source over each target pixel, rounded; exact for any ratio of sizes.
/// The centred window with the target's shape is taken ([`CropWindow::centred`]); nothing is
/// padded.
///
/// ```
/// use image::{Rgb, RgbImage};
///
/// let halves = RgbImage::from_fn(4, 4, |x, _| Rgb([if x < 1 { 200 } else { 100 }; 3]));
/// let small = phalanx_segmentation::downsample(&halves, 2, 2)?;
/// assert_eq!((small[(0, 0)].0, small[(1, 0)].0), ([150; 3], [100; 3]));
/// # Ok::<(), phalanx_segmentation::Error>(())
/// ```
pub fn downsample(image: &RgbImage, width: u32, height: u32) -> Result<RgbImage> {
    let window = CropWindow::centred(image.dimensions(), (width, height))?;
    let mut target = RgbImage::new(width, height);
    area_average::<3>(image, image.width(), window, (width, height), &mut target);
    Ok(target)
}

/// [`downsample`] for masks: 255 where at least half of a target pixel is hand, else 0.
pub fn downsample_mask(mask: &Mask, width: u32, height: u32) -> Result<Mask> {
    let window = CropWindow::centred(mask.dimensions(), (width, height))?;
    let binary = |&level: &u8| if Mask::is_hand_level(level) { 255 } else { 0 };
    let mut target = mask.clone();
    target.iter_mut().for_each(|level| *level = binary(level));
    // A mask that is drawn or was brought to this size before stays as it is.
    if mask.dimensions() != (width, height) {
        let source = target.into_image().into_raw();
        target = Mask::new(width, height);
        area_average::<1>(&source, mask.width(), window, (width, height), &mut target);
        target.iter_mut().for_each(|level| *level = binary(level));
    }
    Ok(target)
}

/// The source pixels that target pixel `i` of `count` covers, and the weights of the first, of
/// each in between and of the last. A source pixel is `count` units long, so that weights are
/// whole; they sum to `length`.
#[derive(Clone, Copy)]
struct Span {
    first: usize,
    last: usize,
    weights: [u32; 3],
}

impl Span {
    fn new(i: u32, count: u32, length: u32) -> Self {
        let [i, count, length] = [i, count, length].map(u64::from);
        let (start, end) = (i * length, (i + 1) * length);
        let (first, last) = (start / count, (end - 1) / count);
        let head = ((first + 1) * count).min(end) - start;
        let tail = if last > first { end - last * count } else { 0 };
        let weights = [head, count, tail].map(|weight| weight as u32);
        Self { first: first as usize, last: last as usize, weights }
    }
}

/// Averages the window of a source with `C` channels and rows of `stride` pixels.
fn area_average<const C: usize>(
    source: &[u8],
    stride: u32,
    window: CropWindow,
    (width, height): (u32, u32),
    target: &mut [u8],
) {
    let spans: Vec<Span> = (0..width).map(|i| Span::new(i, width, window.width)).collect();
    let total = i64::from(window.width) * i64::from(window.height);
    let mut sums = vec![0_u32; window.width as usize * C];
    let row = |y: usize| {
        let start = (window.y as usize + y) * stride as usize + window.x as usize;
        &source[start * C..][..window.width as usize * C]
    };
    for (out, y) in target.chunks_exact_mut(width as usize * C).zip(0..) {
        sum_rows(row, Span::new(y, height, window.height), &mut sums);
        let (columns, _) = sums.as_chunks::<C>();
        for (out, across) in out.chunks_exact_mut(C).zip(&spans) {
            for (level, sum) in out.iter_mut().zip(sum_columns(columns, *across)) {
                // In reals because that is faster; exact, for the numbers are far below 2⁵³.
                *level = ((sum as i64 + total / 2) as f64 / total as f64) as u8;
            }
        }
    }
}

/// The weighted sum of the rows in a span: at most 255 · window height.
fn sum_rows<'a>(row: impl Fn(usize) -> &'a [u8], span: Span, sums: &mut [u32]) {
    let [head, whole, tail] = span.weights;
    sums.fill(0);
    for y in span.first + 1..span.last {
        for (sum, &level) in sums.iter_mut().zip(row(y)) {
            *sum += u32::from(level);
        }
    }
    for ((sum, &first), &last) in sums.iter_mut().zip(row(span.first)).zip(row(span.last)) {
        *sum = head * u32::from(first) + whole * *sum + tail * u32::from(last);
    }
}

fn sum_columns<const C: usize>(columns: &[[u32; C]], span: Span) -> [u64; C] {
    let [head, whole, tail] = span.weights.map(u64::from);
    let mut inner = [0_u64; C];
    for column in columns.get(span.first + 1..span.last).unwrap_or_default() {
        for (sum, &value) in inner.iter_mut().zip(column) {
            *sum += u64::from(value);
        }
    }
    let (first, last) = (columns[span.first], columns[span.last]);
    std::array::from_fn(|c| {
        head * u64::from(first[c]) + whole * inner[c] + tail * u64::from(last[c])
    })
}
