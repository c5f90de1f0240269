# Makes equivalence.json: Rscript equivalence.R > equivalence.json
# Two one-sided tests by t.test and by wilcox.test (exact, no ties).
suppressPackageStartupMessages(library(jsonlite))
set.seed(22)
a <- round(rnorm(14, 100, 8), 3)
b <- round(a + rnorm(14, 0.4, 3), 3)
one_way <- function(test, ...) list(
  p_low = test(a, b, paired = TRUE, mu = -2.5, alternative = "greater", ...)$p.value,
  p_high = test(a, b, paired = TRUE, mu = 3, alternative = "less", ...)$p.value,
  interval = as.vector(test(a, b, paired = TRUE, conf.level = 0.9, conf.int = TRUE, ...)$conf.int))
cat(toJSON(list(versions = list(R = as.character(getRversion())), a = a, b = b, low = -2.5, high = 3,
                by_t = one_way(t.test), by_ranks = one_way(wilcox.test, exact = TRUE)),
           digits = 14, auto_unbox = TRUE))
