# Makes bayes_factor.json: Rscript bayes_factor.R > bayes_factor.json
suppressPackageStartupMessages({library(BayesFactor); library(jsonlite)})
set.seed(23)
cases <- lapply(list(c(8, 0), c(20, 0), c(20, 0.4), c(20, 1), c(60, 0.2)), function(case) {
  a <- round(rnorm(case[1], case[2]), 3)
  b <- round(rnorm(case[1], 0, 0.5), 3)
  list(a = a, b = b, factor = extractBF(ttestBF(a, b, paired = TRUE, rscale = 0.707))$bf)
})
cat(toJSON(list(versions = list(R = as.character(getRversion()),
                                BayesFactor = as.character(packageVersion("BayesFactor"))), cases = cases),
           digits = 14, auto_unbox = TRUE))
