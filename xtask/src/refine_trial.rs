use crate::files;
use crate::sets::Test;
use anyhow::Result;
use clap::Args;
use phalanx::{ItemRandom, OrientationRule, SceneDescriber, Scenes, working_camera};
use phalanx_hand::{Digit, Dof, Pose};
use phalanx_refine::{Evidence, PosePrior, Refinement};
use rayon::prelude::*;

#[derive(Args)]
pub(crate) struct Arguments {
    #[arg(long, value_enum, default_value = "unseen")]
    test: Test,
    #[arg(long, default_value_t = 200)]
    count: usize,
    #[arg(long, default_value_t = 0.5)]
    noise: f64,
    #[arg(long, value_delimiter = ',', default_value = "12/4/6,3/2/6,1/1/6")]
    levels: Vec<String>,
    #[arg(long, value_delimiter = ',', default_value = "side,top,other_side")]
    views: Vec<String>,
    #[arg(long, default_value_t = 1.0)]
    start: f64,
    #[arg(long)]
    own: bool,
    #[arg(long, default_value_t = 1.0)]
    margin: f64,
    #[arg(long)]
    beyond: Option<f64>,
    #[arg(long)]
    model: Option<std::path::PathBuf>,
    #[arg(long, default_value_t = 4000)]
    samples: usize,
    #[arg(long)]
    cameras: bool,
}

fn gauss(r: &mut ItemRandom) -> f64 {
    let (u, v) = (r.uniform().max(1e-12), r.uniform());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

fn deviations(s: f64) -> [f64; 28] {
    let mut d = [0.0; 28];
    for digit in Digit::ALL {
        let dofs = digit.dofs();
        let v = if digit == Digit::Thumb { [7.0, 9.0, 7.0, 0.0] } else { [4.5, 9.0, 13.0, 0.0] };
        for (dof, v) in dofs.into_iter().zip(v) {
            d[dof.index()] = s * f64::to_radians(v);
        }
    }
    d[Dof::ThetaZ.index()] = s * 2.0f64.to_radians();
    d
}

pub(crate) fn run(a: &Arguments) -> Result<()> {
    let (rig0, hand) = (files::rig(None)?, files::hand(None)?);
    let rig = rig0.select(&a.views)?;
    let set = a.test.set(&rig, &hand, &[]);
    let rest = rig.volume.rest_frame();
    let dofs: Vec<Dof> =
        Dof::ALL.into_iter().filter(|d| d.is_internal() || *d == Dof::ThetaZ).collect();
    let dev = deviations(a.start);
    let n = dofs.len();
    let mut cov = vec![0.0; n * n];
    for k in 0..n {
        cov[k * n + k] = dev[dofs[k].index()].powi(2);
    }
    let couple = 3.5f64.to_radians();
    for digit in Digit::ALL {
        let d = digit.dofs();
        let slope = if digit == Digit::Thumb { 4.0 / 3.0 } else { 2.0 / 3.0 };
        let (i, j) = (d[2].index(), d[3].index());
        let v = cov[i * n + i];
        cov[i * n + j] = slope * v;
        cov[j * n + i] = slope * v;
        cov[j * n + j] = slope * slope * v + couple * couple;
    }
    let prior0 = PosePrior::correlated(Pose::REST, &dofs, &cov)?;
    let refinement = Refinement {
        levels: a
            .levels
            .iter()
            .map(|l| {
                let p: Vec<f64> = l.split('/').map(|x| x.parse().unwrap()).collect();
                phalanx_refine::Level { reach: p[0], every: p[1] as usize, steps: p[2] as usize }
            })
            .collect(),
        noise: a.noise,
        margin: a.margin,
        doubt: a.beyond.map(|beyond| phalanx_refine::Doubt {
            beyond,
            cameras: a.cameras.then(|| phalanx_refine::Doubt::default().cameras.unwrap()),
            ..Default::default()
        }),
    };
    let describer = SceneDescriber::new(&rig, OrientationRule::default())?;
    let cams = rig.cameras.iter().map(working_camera).collect::<Result<Vec<_>, _>>()?;
    let step = 2000 / a.count;
    let estimator = match &a.model {
        None => None,
        Some(path) if path.exists() => Some(phalanx::Estimator::from_bytes(&std::fs::read(path)?)?),
        Some(path) => {
            let t = std::time::Instant::now();
            let preset =
                if a.samples <= 4000 { phalanx::Preset::Fast } else { phalanx::Preset::Balanced };
            let scenes = crate::sets::random(&rig, &hand, a.samples, crate::sets::Augment::Yes);
            let bar = crate::progress::Bar::new();
            let e = preset
                .training()
                .shard(&rig, &hand, &scenes, phalanx::Shard::WHOLE, &bar)?
                .finish()?;
            std::fs::write(path, e.to_bytes()?)?;
            println!("trained in {:.0} s", t.elapsed().as_secs_f64());
            Some(e)
        }
    };
    let poses = crate::sets::random(&rig, &hand, 2000, crate::sets::Augment::No).poses;
    let refiner = phalanx::Refiner::new(&rig, &hand, &poses, refinement.clone())?;
    if let Some(e) = &estimator {
        let mut ws = phalanx::Workspace::default();
        let mut d = describer.clone();
        let sil: Vec<_> = d.silhouettes(&set.scene(0))?.cloned().collect();
        let t = std::time::Instant::now();
        for _ in 0..20 {
            e.estimate_silhouettes(&sil, &mut ws)?;
        }
        println!("regression {:.2} ms", t.elapsed().as_secs_f64() * 50.0);
    }
    let out: Vec<_> = (0..a.count)
        .into_par_iter()
        .map_init(
            || describer.clone(),
            |describer, i| -> Result<_> {
                let scene = set.scene(i * step);
                let sil: Vec<_> = describer.silhouettes(&scene)?.cloned().collect();
                let mut r = ItemRandom::new(77, i as u64);
                let mut start = scene.pose;
                for digit in Digit::ALL {
                    let d = digit.dofs();
                    for k in 0..3 {
                        start[d[k]] += dev[d[k].index()] * gauss(&mut r);
                    }
                    let slope = if digit == Digit::Thumb { 4.0 / 3.0 } else { 2.0 / 3.0 };
                    start[d[3]] +=
                        slope * (start[d[2]] - scene.pose[d[2]]) + couple * gauss(&mut r);
                }
                start[Dof::ThetaZ] += dev[Dof::ThetaZ.index()] * gauss(&mut r);
                for dof in Dof::ALL {
                    let (l, h) = dof.range();
                    start[dof] = start[dof].clamp(l, h);
                }
                let mut std = None;
                if let Some(e) = &estimator {
                    let estimate =
                        e.estimate_silhouettes(&sil, &mut phalanx::Workspace::default())?;
                    start = estimate.pose;
                    std = Some(estimate.std);
                }
                let t = std::time::Instant::now();
                let ev = cams
                    .iter()
                    .zip(&sil)
                    .map(|(c, s)| Evidence::new(c, &s.mask))
                    .collect::<Result<Vec<_>, _>>()?;
                let t1 = t.elapsed().as_secs_f64() * 1e3;
                let prior = match std {
                    Some(std) => refiner.prior(&start, &std)?,
                    None => prior0.about(start)?,
                };
                let fit_start = if std.is_some() { *prior.mean() } else { start };
                let h = if a.own { &scene.hand } else { &hand };
                let refined = refinement.run(h, &rest, &ev, &fit_start, &prior)?;
                let truth = refinement.run(h, &rest, &ev, &scene.pose, &prior)?;
                let ms = t.elapsed().as_secs_f64() * 1e3;
                Ok((scene.pose, fit_start, refined, ms, t1, truth))
            },
        )
        .collect::<Result<_>>()?;
    let err = |f: &dyn Fn(usize) -> Pose, dof: Dof| -> f64 {
        (0..out.len()).map(|i| (f(i)[dof] - out[i].0[dof]).abs().to_degrees()).sum::<f64>()
            / out.len() as f64
    };
    let all = |f: &dyn Fn(usize) -> Pose| {
        dofs.iter().map(|&d| err(f, d)).sum::<f64>() / dofs.len() as f64
    };
    println!(
        "start {:.2}  refined {:.2}  from truth {:.2}",
        all(&|i| out[i].1),
        all(&|i| out[i].2.pose),
        all(&|i| out[i].5.pose)
    );
    for d in &dofs {
        print!("{} {:.1}>{:.1}  ", d.name(), err(&|i| out[i].1, *d), err(&|i| out[i].2.pose, *d));
    }
    println!();
    let mut per: Vec<f64> = (0..out.len())
        .map(|i| {
            dofs.iter().map(|&d| (out[i].2.pose[d] - out[i].0[d]).abs().to_degrees()).sum::<f64>()
                / n as f64
        })
        .collect();
    per.sort_by(f64::total_cmp);
    println!(
        "median {:.2} p90 {:.2} max {:.2}",
        per[per.len() / 2],
        per[per.len() * 9 / 10],
        per[per.len() - 1]
    );
    let mut ms: Vec<f64> = out.iter().map(|o| o.3 / 2.0).collect();
    ms.sort_by(f64::total_cmp);
    let ov: f64 = out
        .iter()
        .map(|o| o.2.overlaps.iter().sum::<f64>() / o.2.overlaps.len() as f64)
        .sum::<f64>()
        / out.len() as f64;
    let st: f64 = out.iter().map(|o| o.2.steps as f64).sum::<f64>() / out.len() as f64;
    let mut px: Vec<f64> = out.iter().map(|o| o.2.border_px).collect();
    px.sort_by(f64::total_cmp);
    println!(
        "border px quantiles {:.2} {:.2} {:.2} doubted {}",
        px[px.len() / 20],
        px[px.len() / 2],
        px[px.len() * 19 / 20],
        out.iter().filter(|o| o.2.doubted).count()
    );
    println!(
        "ms median {:.1} p95 {:.1}; evidence {:.2}; overlap {:.3}; steps {:.1}",
        ms[ms.len() / 2],
        ms[ms.len() * 95 / 100],
        out[0].4,
        ov,
        st
    );
    let mut order: Vec<usize> = (0..out.len()).collect();
    let e = |i: usize| dofs.iter().map(|&d| (out[i].2.pose[d] - out[i].0[d]).abs()).sum::<f64>();
    order.sort_by(|&i, &j| e(j).total_cmp(&e(i)));
    for &i in order.iter().take(5) {
        println!(
            "-- {:.1}: energy {:.0} truth {:.0} overlaps {:.3?}",
            e(i).to_degrees() / n as f64,
            out[i].2.energy,
            out[i].5.energy,
            out[i].2.overlaps
        );
        for d in &dofs {
            let x = (out[i].2.pose[*d] - out[i].0[*d]).to_degrees();
            if x.abs() > 10.0 {
                print!(
                    "{} {:.0}: {:+.0} (start {:+.0})  ",
                    d.name(),
                    out[i].0[*d].to_degrees(),
                    x,
                    (out[i].1[*d] - out[i].0[*d]).to_degrees()
                );
            }
        }
        println!();
    }
    dump(
        &rig,
        &hand,
        &order.iter().take(5).map(|&i| (out[i].0, out[i].1, out[i].2.pose)).collect::<Vec<_>>(),
    )?;
    let better = out.iter().filter(|o| o.5.energy < o.2.energy * 0.98).count();
    println!(
        "truth start better energy in {better} of {}; energies {:.1} {:.1}",
        out.len(),
        out.iter().map(|o| o.2.energy).sum::<f64>() / out.len() as f64,
        out.iter().map(|o| o.5.energy).sum::<f64>() / out.len() as f64
    );
    Ok(())
}

pub(crate) fn dump(
    rig: &phalanx_camera::Rig,
    hand: &phalanx_hand::HandShape,
    rows: &[(Pose, Pose, Pose)],
) -> Result<()> {
    let rest = rig.volume.rest_frame();
    let k = 5u32;
    let (w, h) = (120 * k, 90 * k);
    let mut sheet = image::RgbImage::new(w * rig.cameras.len() as u32, h * rows.len() as u32);
    for (r, (truth, start, refined)) in rows.iter().enumerate() {
        for (v, camera) in rig.cameras.iter().enumerate() {
            let big = camera.with_intrinsics(camera.intrinsics.resized(w, h));
            let mut ren = phalanx_render::Renderer::new(&big)?;
            let mut draw = |p: &Pose| ren.silhouette(&hand.pose(p, &rest).primitives);
            let (t, s, f) = (draw(truth)?, draw(start)?, draw(refined)?);
            for y in 0..h {
                for x in 0..w {
                    let a = t.get_pixel(x, y).0[0];
                    let b = f.get_pixel(x, y).0[0];
                    let inner = |m: &image::GrayImage| {
                        m.get_pixel(x, y).0[0] > 127
                            && (m.get_pixel((x + 2).min(w - 1), y).0[0] <= 127
                                || m.get_pixel(x, (y + 2).min(h - 1)).0[0] <= 127
                                || m.get_pixel(x.saturating_sub(2), y).0[0] <= 127
                                || m.get_pixel(x, y.saturating_sub(2)).0[0] <= 127)
                    };
                    let mut px = [a / 3, a / 3, a / 3];
                    if a != b {
                        px = if a > b { [90, 90, 200] } else { [200, 90, 90] };
                    }
                    if inner(&s) {
                        px = [60, 200, 60];
                    }
                    sheet.put_pixel(v as u32 * w + x, r as u32 * h + y, image::Rgb(px));
                }
            }
        }
    }
    sheet.save("/tmp/refine_sheet.png")?;
    Ok(())
}
