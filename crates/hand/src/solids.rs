//! The solids that draw a hand.

use glam::{DMat3, DVec3};

use crate::chain::Chain;
use crate::dof::Digit;
use crate::primitive::{Primitive, Sphere};
use crate::shape::{ForearmShape, HandShape, PalmShape};
use crate::twist::Bone;

/// The solids of a hand as they are made, each with what its spheres move with.
#[derive(Default)]
pub(crate) struct Solids {
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) bones: Vec<[Bone; 3]>,
}

impl Solids {
    /// Every solid, in the frame of the forearm; `palm` is the wrist's rotation.
    pub(crate) fn of(hand: &HandShape, chains: &[Chain; 5], palm: DMat3) -> Self {
        let mut solids = Self::default();
        solids.primitives.push(forearm_solid(&hand.forearm));
        solids.bones.push([Bone::Forearm; 3]);
        solids.push_palm(hand, chains, palm);
        solids.push_thumb_sphere(hand, chains, palm);
        solids.push_segments(&chains[0], Digit::Thumb, &hand.thumb.radii_mm);
        for (k, finger) in hand.fingers().into_iter().enumerate() {
            solids.push_segments(&chains[k + 1], Digit::FINGERS[k], &finger.radii_mm);
        }
        solids
    }

    /// The slab between the wrist and the knuckles, the heel of the hand, and the webs between
    /// the fingers.
    fn push_palm(&mut self, hand: &HandShape, chains: &[Chain; 5], palm: DMat3) {
        let shape = &hand.palm;
        let [thumb_side, little_side] =
            wrist_spheres(shape, palm).map(|sphere| (sphere, Bone::Palm));
        let knuckles: [(Sphere, Bone); 4] = std::array::from_fn(|k| {
            (Sphere::new(chains[k + 1].joints[0], shape.knuckle_radii_mm[k]), Bone::Palm)
        });
        let [index, middle, ring, little] = knuckles;
        let heel = (Sphere::new(palm * shape.heel_mm, shape.heel_radius_mm), Bone::Palm);
        self.wedge([thumb_side, index, middle]);
        self.wedge([thumb_side, little_side, middle]);
        self.wedge([little_side, middle, ring]);
        self.wedge([little_side, heel, ring]);
        self.wedge([heel, ring, little]);
        let fingers = hand.fingers();
        for pair in 0..3 {
            let web = |k: usize| {
                let chain = &chains[k + 1];
                let along = shape.web_reach * fingers[k].lengths_mm[0];
                let center = chain.joints[0] + chain.directions[0] * along;
                (Sphere::new(center, shape.web_radius_mm), Bone::Segment(Digit::FINGERS[k], 0))
            };
            let (near, next) = (web(pair), web(pair + 1));
            self.wedge([knuckles[pair], near, next]);
            self.wedge([knuckles[pair], knuckles[pair + 1], next]);
        }
    }

    /// The sphere of the thumb and the web between thumb and index finger.
    fn push_thumb_sphere(&mut self, hand: &HandShape, chains: &[Chain; 5], palm: DMat3) {
        let shape = &hand.palm;
        let metacarpal = Bone::Segment(Digit::Thumb, 0);
        let [thumb_side, _] = wrist_spheres(shape, palm).map(|sphere| (sphere, Bone::Palm));
        let [base, mcp, ..] = chains[0].joints;
        let index_knuckle = chains[1].joints[0];
        let [base_radius, mcp_radius, ..] = hand.thumb.radii_mm;
        let thin = |at: DVec3| Sphere::new(at, shape.thumb_web_radius_mm);
        let root = (Sphere::new(base, base_radius), metacarpal);
        self.wedge([thumb_side, root, (Sphere::new(mcp, mcp_radius), metacarpal)]);
        self.wedge([
            root,
            (thin(base.lerp(mcp, 0.85)), metacarpal),
            (thin(thumb_side.0.center.lerp(index_knuckle, 0.8)), Bone::Palm),
        ]);
    }

    /// The three segments.
    fn push_segments(&mut self, chain: &Chain, digit: Digit, radii: &[f64; 4]) {
        let spheres = chain.spheres(radii);
        for segment in 0..3 {
            let bone = Bone::Segment(digit, segment);
            self.round_cone([(spheres[segment], bone), (spheres[segment + 1], bone)]);
        }
    }

    fn wedge(&mut self, corners: [(Sphere, Bone); 3]) {
        self.primitives.push(Primitive::Wedge(corners.map(|(sphere, _)| sphere)));
        self.bones.push(corners.map(|(_, bone)| bone));
    }

    fn round_cone(&mut self, ends: [(Sphere, Bone); 2]) {
        self.primitives.push(Primitive::RoundCone(ends.map(|(sphere, _)| sphere)));
        self.bones.push([ends[0].1, ends[1].1, ends[1].1]);
    }
}

fn forearm_solid(forearm: &ForearmShape) -> Primitive {
    let [wrist, far] = forearm.half_widths_mm;
    // The round cap of the wrist's end stays behind the wrist.
    let ends = [
        Sphere::new(DVec3::new(0.0, 0.0, -0.5 * wrist), wrist),
        Sphere::new(DVec3::new(0.0, 0.0, -forearm.length_mm), far),
    ];
    Primitive::GeneralisedCylinder { ends, thin_axis: DVec3::Y, flatness: forearm.flatness }
}

/// The wrist's thumb side and little finger's side.
fn wrist_spheres(shape: &PalmShape, palm: DMat3) -> [Sphere; 2] {
    [1.0, -1.0].map(|side| {
        let center = palm * DVec3::new(side * shape.wrist_half_width_mm, 0.0, 4.0);
        Sphere::new(center, shape.wrist_radius_mm)
    })
}
