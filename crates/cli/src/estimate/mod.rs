//! `phalanx estimate`.

mod stills;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail, ensure};
use clap::Args;
use image::{DynamicImage, RgbImage, imageops};
use phalanx::{
    Estimate, Estimator, ObservedView, Picture, RefinedEstimate, Refiner, ViewDoubt, Workspace,
    draw_overlay, draw_silhouette, draw_window_overlay, mask_from, working_window,
};
use phalanx_hand::HandShape;
use phalanx_refine::PoseFitSettings;
use phalanx_segmentation::Silhouette;

use crate::input::{self, Crop};
use crate::no_hand;
use crate::output::{self, Doubt};
use crate::segment::{Pictures, Prepared, SegmentArguments};
use phalanx_cli::files::{Output, print};
use stills::{Still, stills};

#[derive(Args)]
pub(crate) struct Arguments {
    /// The model, as `phalanx train` writes it.
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// One picture per camera, in the order in which the model was trained, `-` for one that there is not; of
    /// several frames all pictures of the first, then of the second, and so on. Or the pictures that there
    /// are as CAMERA=IMAGE. Or a folder per camera (or one that holds them, named like the cameras), in which
    /// the pictures of one frame have one name.
    #[arg(required = true, value_name = "IMAGE")]
    images: Vec<PathBuf>,
    #[command(flatten)]
    segment: SegmentArguments,
    /// Refine the estimate by drawing the hand and comparing.
    #[arg(long)]
    refine: bool,
    /// The person's hand, as `calibrate-hand` writes it, to refine with; else the model's.
    #[arg(long, value_name = "FILE.toml", requires = "refine")]
    hand: Option<PathBuf>,
    /// Look at this window of every picture only, px.
    #[arg(long, value_name = "X,Y,W,H")]
    crop: Option<Crop>,
    /// Print JSON; of several frames JSON Lines, an object a frame.
    #[arg(long)]
    json: bool,
    /// Draw what was seen and estimated over the pictures of a frame, side by side. With `-` it goes to
    /// standard output, and the estimate to standard error.
    #[arg(long, value_name = "FILE.png")]
    overlay: Option<PathBuf>,
}

/// What every frame is estimated with.
struct Setup<'a> {
    arguments: &'a Arguments,
    pictures: Pictures,
    estimator: Estimator,
    hand: HandShape,
}

/// What is known of a frame, and the pictures that tell it.
struct Answer {
    estimate: Estimate,
    doubts: Vec<Doubt>,
    pictures: Vec<Option<DynamicImage>>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let estimator = input::model(&arguments.model)?;
    let hand = arguments.hand.as_deref().map(input::hand).transpose()?;
    let hand = hand.unwrap_or_else(|| estimator.hand().clone());
    let stills = stills(&estimator.rig().cameras, &arguments.images)?;
    let overlay_to = overlay_output(arguments, &stills)?;
    let setup = Setup { arguments, pictures: arguments.segment.pictures()?, estimator, hand };
    match (&stills[..], overlay_to) {
        ([], _) => bail!("there is no picture in the folders"),
        ([still], overlay_to) => one(&setup, still, overlay_to).map(|()| ExitCode::SUCCESS),
        (_, Some(_)) => bail!("--overlay draws one frame; {} are given", stills.len()),
        (stills, None) => several(&setup, stills),
    }
}

/// Estimates a frame, prints it and draws what is asked for.
fn one(setup: &Setup<'_>, still: &Still, overlay_to: Option<Output>) -> Result<()> {
    let Setup { arguments, estimator, hand, .. } = setup;
    let answer = setup.answer(still, &mut Workspace::default())?;
    let Answer { estimate, mut doubts, pictures } = answer;
    if let Some(output) = &overlay_to {
        // The picture is a by-product: without it the estimate is as good.
        let drawn = overlay(estimator, hand, &estimate, &pictures, &mut doubts);
        if let Err(error) = drawn.and_then(|picture| output.write_png(&picture)) {
            doubts.push(Doubt::whole("no_overlay", format!("there is no overlay: {error:#}")));
        }
    }
    for doubt in &doubts {
        eprintln!("phalanx: {doubt}");
    }
    let result = if arguments.json {
        output::json(estimator, &estimate, &doubts)?
    } else {
        output::text(&estimate)
    };
    if overlay_to.is_some_and(|output| output.is_standard_output()) {
        eprint!("{result}");
        return Ok(());
    }
    print(&result)
}

/// Estimates frames one after the other and prints each as soon as it is known. What fails is named, and
/// the others go on.
fn several(setup: &Setup<'_>, stills: &[Still]) -> Result<ExitCode> {
    let mut workspace = Workspace::default();
    let mut failed = 0;
    for still in stills {
        let name = &still.name;
        let answer = setup.answer(still, &mut workspace);
        let (doubts, error) = match &answer {
            Ok(answer) => (&answer.doubts[..], None),
            Err(error) => (&[][..], Some(format!("{error:#}"))),
        };
        let said = doubts.iter().map(Doubt::to_string).chain(error.clone());
        said.for_each(|said| eprintln!("phalanx: frame {name}: {said}"));
        failed += usize::from(error.is_some());
        let estimated = answer.as_ref().map(|answer| (&answer.estimate, doubts)).ok();
        print(&if setup.arguments.json {
            output::json_line(&setup.estimator, name, estimated, error.as_deref())?
        } else {
            output::named_text(name, estimated.map(|(estimate, _)| estimate))
        })?;
    }
    ensure!(failed < stills.len(), "none of the {failed} frames could be estimated");
    Ok(if failed == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

impl Setup<'_> {
    fn answer(&self, still: &Still, workspace: &mut Workspace) -> Result<Answer> {
        let Self { arguments, estimator, hand, .. } = self;
        let picture = |path: &Option<PathBuf>| -> Result<Option<DynamicImage>> {
            path.as_ref().map(|path| input::picture(path, arguments.crop)).transpose()
        };
        let pictures = still.paths.iter().map(picture).collect::<Result<Vec<_>>>()?;
        let prepared = self.prepared(&still.paths, &pictures)?;
        let views: Vec<Option<Picture<'_>>> =
            prepared.iter().map(|picture| picture.as_ref().map(Prepared::as_picture)).collect();
        let estimate = estimator
            .estimate(&views, workspace)
            .map_err(|error| no_hand::explained(error, estimator, &prepared))?;
        let mut doubts = Vec::new();
        let estimate = if arguments.refine {
            refine(estimator, hand, estimate, &mut doubts)?
        } else {
            estimate
        };
        let of_views = estimator.explain(&views, &estimate, workspace)?;
        let in_words = |doubt: &ViewDoubt| {
            let why =
                prepared[doubt.view].as_ref().and_then(|seen| no_hand::why(doubt.cause, seen));
            Doubt::of_view(estimator, doubt).because(why)
        };
        doubts.extend(of_views.iter().map(in_words));
        Ok(Answer { estimate, doubts, pictures })
    }

    /// The pictures as the estimator takes them.
    fn prepared(
        &self,
        paths: &[Option<PathBuf>],
        pictures: &[Option<DynamicImage>],
    ) -> Result<Vec<Option<Prepared<'_>>>> {
        if matches!(self.pictures, Pictures::Masks) {
            let mut given = paths.iter().flatten().zip(pictures.iter().flatten());
            given.try_for_each(|(path, picture)| check_levels(path, picture))?;
        }
        // More pictures than cameras are the estimator's to refuse.
        let names = self.estimator.rig().cameras.iter().map(|camera| camera.name.as_str());
        let named = pictures.iter().zip(names.chain(std::iter::repeat("")));
        let prepared = |(picture, name): (&Option<DynamicImage>, &str)| {
            picture.as_ref().map(|picture| self.pictures.prepared(name, picture)).transpose()
        };
        named.map(prepared).collect()
    }
}

/// Where the overlay goes, if one is asked for.
fn overlay_output(arguments: &Arguments, stills: &[Still]) -> Result<Option<Output>> {
    let Some(path) = &arguments.overlay else { return Ok(None) };
    let pictures = stills.iter().flat_map(|still| still.paths.iter().flatten());
    let files = arguments.hand.iter().chain([&arguments.model]).chain(arguments.segment.path());
    let inputs = pictures.chain(files);
    let output = Output::new(path, &inputs.collect::<Vec<_>>())?;
    if output.is_file() && !is_png(path) {
        bail!("{}: the overlay is written as PNG; name it so", path.display());
    }
    Ok(Some(output))
}

/// The refined estimate. That it did not settle is a doubt.
fn refine(
    estimator: &Estimator,
    hand: &HandShape,
    estimate: Estimate,
    doubts: &mut Vec<Doubt>,
) -> Result<Estimate> {
    let refinement = PoseFitSettings::of_strangers();
    let refiner = Refiner::for_estimator(estimator, refinement)?.with_hand(hand)?;
    let RefinedEstimate { refined, fit, .. } = refiner.refine_estimate(estimator, estimate)?;
    if !fit.converged {
        let text = "the refinement stopped before it settled".to_owned();
        doubts.push(Doubt::whole("unsettled", text));
    }
    Ok(refined)
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"))
}

/// Refuses a mask in which nothing is hand, but something may have been meant to be.
fn check_levels(path: &Path, picture: &DynamicImage) -> Result<()> {
    if let Some(level @ 1..=127) = mask_from(picture).iter().max() {
        bail!(
            "{}: brighter than 127 is hand; the brightest pixel has level {level}",
            path.display()
        );
    }
    Ok(())
}

/// The pictures that show the hand, side by side with what was seen and estimated. An estimated hand that
/// cannot be drawn is a doubt.
fn overlay(
    estimator: &Estimator,
    hand: &HandShape,
    estimate: &Estimate,
    pictures: &[Option<DynamicImage>],
    doubts: &mut Vec<Doubt>,
) -> Result<RgbImage> {
    let rest = estimator.rig().volume.rest_frame();
    let mut panels = Vec::new();
    for ObservedView { camera: view, silhouette: observed, window, .. } in
        &estimate.observation.views
    {
        let camera = &estimator.rig().cameras[*view];
        let drawn_by = window.as_ref().map_or(camera, |window| &window.camera);
        let drawn = draw_silhouette(drawn_by, hand, &estimate.pose, &rest);
        let estimated = drawn
            .map_err(anyhow::Error::from)
            .and_then(|drawn| Silhouette::from_mask(&drawn).map_err(anyhow::Error::from));
        if let Err(reason) = &estimated {
            let text = format!("the estimated hand is not drawn: {reason}");
            doubts.push(Doubt::view(&camera.name, "not_drawn", text));
        }
        let Some(picture) = &pictures[*view] else { continue };
        let mut canvas = picture.to_rgb8();
        let estimated = estimated.as_ref().ok();
        if let Some(window) = window {
            draw_window_overlay(&mut canvas, window, observed, estimated);
        } else {
            let shown = working_window(canvas.dimensions())?;
            draw_overlay(&mut canvas, shown, observed, estimator.orientation(), estimated);
        }
        panels.push(canvas);
    }
    Ok(side_by_side(&panels))
}

fn side_by_side(panels: &[RgbImage]) -> RgbImage {
    let width = panels.iter().map(RgbImage::width).sum();
    let height = panels.iter().map(RgbImage::height).max().unwrap_or_default();
    let mut all = RgbImage::new(width, height);
    let mut x = 0;
    for panel in panels {
        imageops::replace(&mut all, panel, x, 0);
        x += i64::from(panel.width());
    }
    all
}
