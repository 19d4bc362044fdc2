/// Which column each row gets, so that the sum of the costs is smallest: Jonker and Volgenant's
/// shortest augmenting paths (1987), for as many columns as rows or more.
#[derive(Debug, Clone, Default)]
pub(crate) struct Assignment {
    /// What is added to a row's costs, and to a column's: all sums are then at least zero, and zero
    /// where a row has its column.
    of_row: Vec<f64>,
    of_column: Vec<f64>,
    /// The row that has each column.
    row: Vec<Option<usize>>,
    /// The column that each row has.
    column: Vec<usize>,
    path: Path,
}

/// The shortest paths from one row to the columns, as far as they are known.
#[derive(Debug, Clone, Default)]
struct Path {
    length: Vec<f64>,
    /// The column before each; none for those that begin the path.
    before: Vec<Option<usize>>,
    /// Columns whose length is final, in order, and whether each is among them.
    settled: Vec<usize>,
    is_settled: Vec<bool>,
}

impl Assignment {
    /// The column of each row of `costs`, which are finite and have so many columns.
    pub(crate) fn solve(&mut self, costs: &[f32], columns: usize) -> &[usize] {
        let rows = costs.len() / columns;
        self.of_row.clear();
        self.of_row.resize(rows, 0.0);
        self.of_column.clear();
        self.of_column.resize(columns, 0.0);
        self.row.clear();
        self.row.resize(columns, None);
        self.column.clear();
        self.column.resize(rows, 0);
        for row in 0..rows {
            self.augment(costs, columns, row);
        }
        &self.column
    }

    /// Gives a row a column, and moves other rows to other columns where that is cheaper.
    fn augment(&mut self, costs: &[f32], columns: usize, start: usize) {
        self.path.begin(columns);
        let (mut row, mut reached, mut last) = (start, 0.0, None);
        let free = loop {
            let of_row = &costs[row * columns..(row + 1) * columns];
            let base = reached - self.of_row[row];
            let Some(nearest) = self.path.extend(of_row, base, &self.of_column, last) else {
                return;
            };
            reached = self.path.length[nearest];
            self.path.settle(nearest);
            match self.row[nearest] {
                Some(taken_by) => (row, last) = (taken_by, Some(nearest)),
                None => break nearest,
            }
        };
        self.of_row[start] += reached;
        for &column in &self.path.settled {
            let slack = reached - self.path.length[column];
            self.of_column[column] -= slack;
            if let Some(row) = self.row[column] {
                self.of_row[row] += slack;
            }
        }
        let mut column = free;
        while let Some(before) = self.path.before[column] {
            self.row[column] = self.row[before];
            column = before;
        }
        self.row[column] = Some(start);
        for (column, row) in self.row.iter().enumerate() {
            if let Some(row) = *row {
                self.column[row] = column;
            }
        }
    }
}

impl Path {
    fn begin(&mut self, columns: usize) {
        self.length.clear();
        self.length.resize(columns, f64::INFINITY);
        self.before.clear();
        self.before.resize(columns, None);
        self.settled.clear();
        self.is_settled.clear();
        self.is_settled.resize(columns, false);
    }

    /// Goes on from the row that has the column `last` to every column, and returns the nearest of
    /// those that are not settled, the first of equals.
    fn extend(
        &mut self,
        costs: &[f32],
        base: f64,
        of_column: &[f64],
        last: Option<usize>,
    ) -> Option<usize> {
        let mut nearest = None;
        let mut shortest = f64::INFINITY;
        for column in (0..costs.len()).filter(|&column| !self.is_settled[column]) {
            let length = base + f64::from(costs[column]) - of_column[column];
            if length < self.length[column] {
                self.length[column] = length;
                self.before[column] = last;
            }
            if self.length[column] < shortest {
                (shortest, nearest) = (self.length[column], Some(column));
            }
        }
        nearest
    }

    fn settle(&mut self, column: usize) {
        self.is_settled[column] = true;
        self.settled.push(column);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The least sum, by trying every way.
    fn slow(costs: &[f32], columns: usize, row: usize, taken: u32) -> f64 {
        if row * columns == costs.len() {
            return 0.0;
        }
        let free = (0..columns).filter(|column| taken >> column & 1 == 0);
        free.map(|column| {
            let rest = slow(costs, columns, row + 1, taken | 1 << column);
            f64::from(costs[row * columns + column]) + rest
        })
        .fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(crate::property::cases(400))]

        #[test]
        fn no_other_way_is_cheaper(
            (columns, costs) in (1..7_usize).prop_flat_map(|columns| {
                let cost = prop_oneof![0.0..1.0_f32, (0..3_u8).prop_map(f32::from)];
                let costs = prop::collection::vec(cost, columns..=columns * columns);
                (Just(columns), costs.prop_map(move |mut costs| {
                    costs.truncate(costs.len() / columns * columns);
                    costs
                }))
            }),
        ) {
            let mut assignment = Assignment::default();
            let found = assignment.solve(&costs, columns).to_vec();
            let mut different = found.clone();
            different.sort_unstable();
            different.dedup();
            prop_assert_eq!(different.len(), found.len());
            let cost = |(row, &column): (usize, &usize)| f64::from(costs[row * columns + column]);
            let sum: f64 = found.iter().enumerate().map(cost).sum();
            prop_assert!((sum - slow(&costs, columns, 0, 0)).abs() < 1e-9);
            prop_assert_eq!(assignment.solve(&costs, columns), &found[..]);
        }
    }
}
