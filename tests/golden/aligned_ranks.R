# Makes aligned_ranks.json: Rscript aligned_ranks.R > aligned_ranks.json
# The aligned rank transform written out in R, tested by aov with each effect against its own interaction with
# participants; contrasts by ART-C and t.test. Ratings with ties (2 x 2 x 2) and numbers (2 x 3).
suppressPackageStartupMessages(library(jsonlite))
options(contrasts = c("contr.sum", "contr.poly"))

aligned <- function(data, factors, effect) {
  residual <- data$value - ave(data$value, data[factors], FUN = mean)
  # The effect's estimate: means over ever smaller sets of its factors, signs alternating (inclusion-exclusion).
  estimate <- 0
  for (size in 0:length(effect)) for (set in combn(seq_along(effect), size, simplify = FALSE)) {
    mean_of_set <- if (size == 0) rep(mean(data$value), nrow(data)) else
      ave(data$value, data[effect[set]], FUN = mean)
    estimate <- estimate + (-1)^(length(effect) - size) * mean_of_set
  }
  residual + estimate
}

tested <- function(data, factors, effect) {
  data$rank <- rank(round(aligned(data, factors, effect), 9))
  crossed <- paste(factors, collapse = "*")
  model <- aov(as.formula(paste("rank ~", crossed, "+ Error(participant/(", crossed, "))")), data)
  name <- paste(effect, collapse = ":")
  for (stratum in summary(model)) {
    table <- stratum[[1]]
    row <- match(name, trimws(rownames(table)))
    if (!is.na(row)) return(list(f = table[row, "F value"], df = table[["Df"]][c(row, nrow(table))],
                                 p = table[row, "Pr(>F)"],
                                 partial_eta_squared = table[row, "Sum Sq"] / sum(table[c(row, nrow(table)), "Sum Sq"])))
  }
}

contrasts_of <- function(data, factors, of) {
  residual <- data$value - ave(data$value, data[factors], FUN = mean)
  data$rank <- rank(round(residual + ave(data$value, data[of], FUN = mean) - mean(data$value), 9))
  data$cell <- do.call(paste, c(data[of], sep = ", "))
  means <- tapply(data$rank, list(data$participant, data$cell), mean)
  cells <- sort(colnames(means))
  lapply(combn(cells, 2, simplify = FALSE), function(pair) {
    test <- t.test(means[, pair[1]], means[, pair[2]], paired = TRUE)
    list(a = pair[1], b = pair[2], t = unname(test$statistic), df = unname(test$parameter), p = test$p.value)
  })
}

report <- function(data, factors, of) {
  effects <- unlist(lapply(seq_along(factors), function(size) combn(factors, size, simplify = FALSE)), FALSE)
  names(effects) <- sapply(effects, paste, collapse = ":")
  data[c("participant", factors)] <- lapply(data[c("participant", factors)], factor)
  list(data = data, factors = I(factors), effects = lapply(effects, function(effect) tested(data, factors, effect)),
       of = I(of), contrasts = contrasts_of(data, factors, of))
}

set.seed(21)
ratings <- expand.grid(participant = sprintf("%02d", 1:12), intensity = c("light", "intense"),
                       variety = c("easy", "hard"), transition = c("on", "off"), stringsAsFactors = FALSE)
ratings$value <- pmin(7, pmax(1, round(4 + rnorm(12)[factor(ratings$participant)] +
  0.6 * (ratings$transition == "on") + 0.7 * (ratings$intensity == "light" & ratings$variety == "easy") +
  rnorm(nrow(ratings)))))
numbers <- expand.grid(participant = sprintf("%02d", 1:9), side = c("left", "right"), speed = c("a", "b", "c"),
                       stringsAsFactors = FALSE)
numbers$value <- round(exp(rnorm(nrow(numbers)) + 0.8 * (numbers$speed == "c") + 0.5 * (numbers$side == "left")), 4)
found <- list(versions = list(R = as.character(getRversion())),
              ratings = report(ratings, c("intensity", "variety", "transition"), c("intensity", "variety")),
              numbers = report(numbers, c("side", "speed"), "speed"))
cat(toJSON(found, digits = 14, auto_unbox = TRUE, dataframe = "columns"))
