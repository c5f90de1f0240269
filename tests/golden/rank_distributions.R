# Makes rank_distributions.json: Rscript rank_distributions.R > rank_distributions.json
# Signed-rank tests with ties and zeros, their exact distributions and Hodges-Lehmann estimates; Friedman's test in
# its two forms, with the exact p of all orders; the Skillings-Mack statistic, written out after the paper (1981).
suppressPackageStartupMessages({library(coin); library(exactRankTests); library(MASS); library(jsonlite)})
set.seed(20)

signed_ranks <- function(d) {
  zero <- rep(0, length(d))
  tests <- lapply(c(drop = "Wilcoxon", pratt = "Pratt"), function(method) {
    one <- function(alternative) wilcoxsign_test(d ~ zero, zero.method = method, distribution = "exact",
                                                 alternative = alternative)
    list(z = unname(statistic(one("two.sided"))), two_sided = pvalue(one("two.sided")),
         greater = pvalue(one("greater")), less = pvalue(one("less")))
  })
  again <- wilcox.exact(d, conf.int = TRUE)
  tied <- any(d == 0) || any(duplicated(abs(d)))
  found <- if (tied) NULL else wilcox.test(d, conf.int = TRUE, exact = TRUE)
  list(differences = d, coin = tests, v = unname(again$statistic), p = again$p.value, tied = tied,
       estimate = if (tied) NULL else unname(found$estimate),
       interval = if (tied) NULL else as.numeric(found$conf.int),
       interval_90 = if (tied) NULL else as.numeric(wilcox.test(d, conf.int = TRUE, conf.level = 0.9)$conf.int),
       exact_rank_tests = if (tied) NULL else c(unname(again$estimate), as.numeric(again$conf.int)))
}

orders <- function(row) {
  if (length(row) == 1) return(matrix(row))
  do.call(rbind, lapply(seq_along(row), function(first) cbind(row[first], orders(row[-first]))))
}

# All ways to reorder each person's ranks, one by one.
all_orders_p <- function(table) {
  ranks <- t(apply(table, 1, rank))
  sums <- matrix(0, 1, ncol(table))
  for (person in seq_len(nrow(table))) {
    ways <- orders(ranks[person, ])
    sums <- sums[rep(seq_len(nrow(sums)), each = nrow(ways)), , drop = FALSE] +
      ways[rep(seq_len(nrow(ways)), nrow(sums)), , drop = FALSE]
  }
  mean(rowSums(sums^2) >= sum(colSums(ranks)^2) - 1e-9)
}

ranked_table <- function(table, exact) {
  test <- friedman.test(table)
  n <- nrow(table); k <- ncol(table); q <- unname(test$statistic)
  long <- data.frame(value = as.vector(t(table)), condition = factor(rep(seq_len(k), n)),
                     person = factor(rep(seq_len(n), each = k)))
  f <- (n - 1) * q / (n * (k - 1) - q)
  list(table = table, chi_squared = q, p = test$p.value,
       coin_chi_squared = unname(statistic(friedman_test(value ~ condition | person, long))),
       f = f, f_p = pf(f, k - 1, (n - 1) * (k - 1), lower.tail = FALSE),
       exact_p = if (exact) all_orders_p(table) else NULL)
}

skillings_mack <- function(table) {
  k <- ncol(table)
  table <- table[rowSums(!is.na(table)) > 1, ]
  adjusted <- numeric(k); covariance <- matrix(0, k, k)
  for (person in seq_len(nrow(table))) {
    has <- !is.na(table[person, ]); many <- sum(has)
    ranks <- rep((many + 1) / 2, k)
    ranks[has] <- rank(table[person, has])
    adjusted <- adjusted + sqrt(12 / (many + 1)) * (ranks - (many + 1) / 2)
    covariance <- covariance - outer(has, has)
  }
  diag(covariance) <- 0
  diag(covariance) <- -rowSums(covariance)
  statistic <- as.numeric(t(adjusted) %*% ginv(covariance) %*% adjusted)
  list(table = table, statistic = statistic, df = k - 1, p = pchisq(statistic, k - 1, lower.tail = FALSE))
}

with_holes <- function(n, k, holes) {
  table <- matrix(round(rnorm(n * k), 4), n) + rep(seq_len(k) / 4, each = n)
  table[sample(n * k, holes)] <- NA
  table
}

assembly <- matrix(c(3.2, 4.1, 3.8, 4.2, 3.1, 3.9, 3.4, 4.0, 4.3, 3.5, 4.6, 4.8, 3.5, 3.6, 3.9, 4.0, 3.6, 4.2, 3.7,
                     3.9, 4.5, 4.7, 3.7, NA, NA, 4.2, 3.4, NA, 4.3, 4.6, 4.4, 4.9, 3.5, NA, 3.7, 3.9), 9, byrow = TRUE)
ratings <- function(n, k) matrix(sample(1:4, n * k, replace = TRUE), n)
cat(toJSON(list(
  versions = list(R = as.character(getRversion()), coin = as.character(packageVersion("coin")),
                  exactRankTests = as.character(packageVersion("exactRankTests")),
                  MASS = as.character(packageVersion("MASS"))),
  signed_ranks = list(
    continuous_8 = signed_ranks(round(rnorm(8, 0.4), 4)), continuous_20 = signed_ranks(round(rnorm(20, 0.5), 4)),
    continuous_25 = signed_ranks(round(rnorm(25), 4)), ratings_6 = signed_ranks(c(0, 1, 1, -1, 2, 3)),
    ratings_12 = signed_ranks(sample(-2:4, 12, replace = TRUE)),
    ratings_20 = signed_ranks(sample(-2:3, 20, replace = TRUE)),
    ratings_25 = signed_ranks(sample(-3:3, 25, replace = TRUE)),
    ratings_40 = signed_ranks(sample(-3:4, 40, replace = TRUE))),
  friedman = list(
    continuous_5_3 = ranked_table(matrix(round(rnorm(15), 4), 5), TRUE),
    continuous_20_4 = ranked_table(matrix(round(rnorm(80), 4), 20) + rep(1:4 / 3, each = 20), FALSE),
    ratings_6_3 = ranked_table(ratings(6, 3), TRUE), ratings_4_4 = ranked_table(ratings(4, 4), TRUE),
    ratings_20_8 = ranked_table(ratings(20, 8), FALSE)),
  skillings_mack = list(assembly_times = skillings_mack(assembly), holes_12_4 = skillings_mack(with_holes(12, 4, 7)),
                        holes_20_8 = skillings_mack(with_holes(20, 8, 25)))
), digits = I(15), auto_unbox = TRUE, na = "null", null = "null"), "\n")
